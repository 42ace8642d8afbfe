//! Jobs on Slurm: its daemons on the loopback device, in a folder and on ports of their own, and what becomes of a job when they are killed.

use crate::common::{Folder, bytes};
use crate::jobs::{COMMANDS, inputs};
use crate::workers::commands;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The daemons, which end with the test.
struct Cluster {
    folder: PathBuf,
    munged: Child,
    controller: Child,
    nodes: Vec<Child>,
}

/// Where Debian puts daemons is not on every path.
fn path() -> String {
    format!("{}:/usr/sbin:/sbin", std::env::var("PATH").unwrap_or_default())
}

fn is_there(program: &str) -> bool {
    path().split(':').any(|folder| Path::new(folder).join(program).is_file())
}

fn output(command: &mut Command) -> String {
    command.output().map_or_else(|_| String::new(), |done| String::from_utf8_lossy(&done.stdout).trim().to_owned())
}

/// Waits until something holds.
fn wait_for(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < Duration::from_secs(240), "{what}: not within four minutes");
        std::thread::sleep(Duration::from_millis(50));
    }
}

impl Cluster {
    /// Two nodes of two processors each, on this machine. None, loudly, where Slurm is not installed.
    fn start(test: &str, folder: &Path) -> Option<Self> {
        if let Some(program) = ["munged", "slurmctld", "slurmd", "sbatch"].iter().find(|program| !is_there(program)) {
            eprintln!("SKIPPED {test}: {program} is not installed");
            return None;
        }
        std::fs::create_dir(folder).unwrap();
        let at = |name: &str| folder.join(name);
        let listeners: Vec<TcpListener> = (0..3).map(|_| TcpListener::bind("127.0.0.1:0").unwrap()).collect();
        let ports: Vec<u16> = listeners.iter().map(|listener| listener.local_addr().unwrap().port()).collect();
        drop(listeners);
        let (host, user) = (output(&mut Command::new("hostname")), output(Command::new("id").arg("-un")));
        let here = folder.display();
        let mut conf = format!(
            "ClusterName=sightlines\nSlurmctldHost={host}(127.0.0.1)\nSlurmUser={user}\nSlurmdUser={user}\n\
             AuthType=auth/munge\nAuthInfo=socket={here}/socket,cred_expire=5\nStateSaveLocation={here}/state\nSlurmdSpoolDir={here}/%n\n\
             SlurmctldPidFile={here}/ctld.pid\nSlurmdPidFile={here}/%n.pid\nSlurmctldPort={}\n\
             ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSelectType=select/cons_tres\n\
             SelectTypeParameters=CR_Core\nReturnToService=2\nJobRequeue=1\nSlurmctldTimeout=30\nSlurmdTimeout=10\n\
             JobAcctGatherType=jobacct_gather/none\nAccountingStorageType=accounting_storage/none\n\
             CommunicationParameters=NoCtldInAddrAny,NoInAddrAny\nSchedulerParameters=sched_interval=1,batch_sched_delay=1\n\
             PartitionName=bake Nodes=w0,w1 Default=YES MaxTime=INFINITE State=UP\n",
            ports[0]
        );
        for (k, port) in ports[1..].iter().enumerate() {
            conf +=
                &format!("NodeName=w{k} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=2 RealMemory=500\n");
            std::fs::create_dir(at(&format!("w{k}"))).unwrap();
        }
        std::fs::create_dir(at("state")).unwrap();
        std::fs::write(at("slurm.conf"), conf).unwrap();
        std::fs::write(
            at("key"),
            format!("{:064}{}", std::process::id(), "a key that nobody else has to know ".repeat(8)),
        )
        .unwrap();
        let chmod =
            |mode: &str, path: &Path| assert!(Command::new("chmod").arg(mode).arg(path).status().unwrap().success());
        chmod("400", &at("key"));
        chmod("755", folder);
        let mut munged = Command::new("munged");
        munged.args(["--foreground", "--force"]);
        for (option, file) in [
            ("key-file", "key"),
            ("socket", "socket"),
            ("pid-file", "munged.pid"),
            ("log-file", "munged.log"),
            ("seed-file", "seed"),
        ] {
            munged.arg(format!("--{option}={here}/{file}"));
        }
        let munged = Self::spawn(folder, &mut munged, "munged");
        wait_for("munged", || at("socket").exists());
        let controller = Self::controller(folder);
        let mut cluster = Self { folder: folder.to_owned(), munged, controller, nodes: Vec::new() };
        cluster.nodes = vec![cluster.node(0), cluster.node(1)];
        wait_for("two idle nodes", || cluster.ask(&["sinfo", "-h", "-t", "idle", "-o", "%D"]) == "2");
        Some(cluster)
    }

    fn spawn(folder: &Path, command: &mut Command, name: &str) -> Child {
        let log = std::fs::File::options().create(true).append(true).open(folder.join(format!("{name}.out"))).unwrap();
        command.env("PATH", path()).stdin(Stdio::null()).stdout(log.try_clone().unwrap()).stderr(log);
        command.spawn().unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn controller(folder: &Path) -> Child {
        Self::spawn(folder, Command::new("slurmctld").arg("-D").arg("-f").arg(folder.join("slurm.conf")), "slurmctld")
    }

    fn node(&self, k: usize) -> Child {
        let name = format!("w{k}");
        let mut command = Command::new("slurmd");
        command.args(["-D", "-N", &name, "-f"]).arg(self.folder.join("slurm.conf"));
        Self::spawn(&self.folder, &mut command, &name)
    }

    fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new(program);
        command.env("SLURM_CONF", self.folder.join("slurm.conf")).env("PATH", path());
        command
    }

    /// A controller that has forgotten what it started last takes a node out of use, until somebody who looks after the cluster puts it back.
    fn put_back(&self, nodes: &[&str]) {
        for node in nodes {
            if self.ask(&["sinfo", "-h", "-n", node, "-t", "drain", "-o", "%D"]) == "1" {
                self.ask(&["scontrol", "update", &format!("NodeName={node}"), "State=RESUME"]);
            }
        }
    }

    fn ask(&self, words: &[&str]) -> String {
        output(self.command(words[0]).args(&words[1..]))
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        // Steps of jobs would outlive their node.
        let _ = self.ask(&["scancel", "--signal=KILL", "--full", "-u", &output(Command::new("id").arg("-un"))]);
        let daemons = self.nodes.iter_mut().chain([&mut self.controller, &mut self.munged]);
        for daemon in daemons {
            let _ = daemon.kill().and_then(|()| daemon.wait().map(drop));
        }
        if std::thread::panicking() {
            for log in ["slurmctld.out", "w0.out", "w1.out", "munged.out"] {
                let text = std::fs::read_to_string(self.folder.join(log)).unwrap_or_default();
                let last: Vec<&str> = text.lines().rev().take(15).collect();
                eprintln!("{log}, last line first:\n{}", last.join("\n"));
            }
        }
    }
}

/// Numbers of processes that do `what` for a job.
fn processes(job: &Path, what: &[u8]) -> Vec<u32> {
    let job = job.display().to_string();
    let processes = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let pid = |entry: std::fs::DirEntry| entry.file_name().to_str()?.parse().ok();
    let does = |pid: &u32| {
        let line = std::fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        let words: Vec<&[u8]> = line.split(|&byte| byte == 0).collect();
        words.windows(3).any(|w| w[0] == b"job" && w[1] == what && w[2] == job.as_bytes())
    };
    processes.filter_map(pid).filter(does).collect()
}

fn n_parts(folder: &Folder) -> usize {
    let names = crate::common::names(&folder.path("job/parts"));
    names.iter().filter(|name| name.ends_with(".part")).count()
}

/// Workers as tasks of an array, the first of which is killed, end with the bytes that each kind of command writes.
fn workers_on_slurm(folder: &Folder, cluster: &Cluster) {
    folder.run(&["generate", "world", "--blocks", "2", "--per-tile", "1", "-o", "city"]).expect(0);
    let program = env!("CARGO_BIN_EXE_sightlines");
    let kill =
        |pid: u32| Command::new("kill").args(["-9", &pid.to_string()]).status().is_ok_and(|status| status.success());
    let mut n_killed = 0;
    for (k, (command, out)) in commands().into_iter().enumerate() {
        let words =
            |out| -> Vec<&str> { command.split(' ').map(|word| if word == "OUT" { out } else { word }).collect() };
        let (alone, shared) = (format!("alone{k}-{out}"), format!("workers{k}-{out}"));
        folder.run(&words(&alone)).expect(0);
        let name = format!("job{k}");
        folder.run(&[&["job", "plan", "-o", &name, "--shards", "24"][..], &words(&shared)].concat()).expect(0);
        let job = folder.path(&name).canonicalize().unwrap();
        let line = format!("'{program}' job work '{}' --workers 3 -q", job.display());
        let logs = format!("--output={}/worker-%a.log", job.display());
        let number = cluster.ask(&["sbatch", "--parsable", "--array=0-2", &logs, "--wrap", &line]);
        assert!(number.parse::<u64>().is_ok(), "{number}");
        let is_over = || cluster.ask(&["squeue", "-h", "-j", &number]).is_empty();
        wait_for("a worker that can be killed", || {
            let was_killed = processes(&job, b"work").first().is_some_and(|&pid| kill(pid));
            n_killed += usize::from(was_killed);
            was_killed || is_over()
        });
        wait_for("the end of all workers", is_over);
        assert!(bytes(folder, &shared) == bytes(folder, &alone), "{command}");
    }
    eprintln!("workers on Slurm: {} commands, {n_killed} workers killed", commands().len());
    assert!(n_killed > 0);
}

/// With this variable set, the controller and a node are killed too. Slurm 22.05 may then keep a task of the dead node for ever, or hold one that it could
/// not start; the submission gives these up, which takes a while, so this is for people who watch.
const DAEMONS: &str = "SIGHTLINES_SLURM_FAULTS";

/// With a shard killed in the middle, and the controller and a node too if that is wanted, a job ends with the bytes of a build.
#[cfg(unix)]
#[test]
fn a_job_on_slurm_gives_the_bytes_of_a_build() {
    const TEST: &str = "a_job_on_slurm_gives_the_bytes_of_a_build";
    let kills_daemons = std::env::var_os(DAEMONS).is_some();
    if !kills_daemons {
        eprintln!("SKIPPED a part of {TEST}: no daemon is killed without {DAEMONS}");
    }
    let folder = inputs();
    let Some(mut cluster) = Cluster::start(TEST, &folder.path("slurm")) else { return };
    let start = Instant::now();
    let command = COMMANDS[0].0.replace("OUT", "out.pvs").replace("5,3,1", "6,4,1");
    let words: Vec<&str> = command.split(' ').collect();
    folder.run(&words).expect(0);
    let whole = folder.read("out.pvs");
    std::fs::remove_file(folder.path("out.pvs")).unwrap();
    folder.run(&[&["job", "plan", "-o", "job", "--shards", "24"][..], &words].concat()).expect(0);
    let mut submit = cluster.command(env!("CARGO_BIN_EXE_sightlines"));
    submit.args(["job", "submit", "job", "--engine", "slurm", "--json"]).current_dir(folder.path("."));
    let mut submit = submit.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let kill =
        |pid: u32| Command::new("kill").args(["-9", &pid.to_string()]).status().is_ok_and(|status| status.success());
    let job = folder.path("job").canonicalize().unwrap();
    let mut n_killed = 0;
    wait_for("a shard that can be killed", || {
        n_killed += processes(&job, b"shard").first().is_some_and(|&pid| kill(pid)) as usize;
        n_killed > 0
    });
    let (mut at_controller, mut at_node) = (0, 0);
    if kills_daemons {
        wait_for("parts", || n_parts(&folder) >= 3 || submit.try_wait().unwrap().is_some());
        at_controller = n_parts(&folder);
        cluster.controller.kill().unwrap();
        cluster.controller.wait().unwrap();
        std::thread::sleep(Duration::from_millis(300));
        cluster.controller = Cluster::controller(&cluster.folder);
        wait_for("more parts", || {
            cluster.put_back(&["w0", "w1"]);
            n_parts(&folder) >= 7 || submit.try_wait().unwrap().is_some()
        });
        at_node = n_parts(&folder);
        cluster.nodes[1].kill().unwrap();
        cluster.nodes[1].wait().unwrap();
    }
    wait_for("the end", || {
        cluster.put_back(if kills_daemons { &["w0"] } else { &["w0", "w1"] });
        submit.try_wait().unwrap().is_some()
    });
    let ended = submit.wait_with_output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&ended.stdout), String::from_utf8_lossy(&ended.stderr));
    assert_eq!(ended.status.code(), Some(0), "{out}{err}");
    assert!(folder.read("out.pvs") == whole);
    assert!(at_controller < 24 && at_node < 24, "the daemons were killed too late: {at_controller}, {at_node}");
    workers_on_slurm(&folder, &cluster);
    eprintln!(
        "{TEST}: a shard and a worker killed; the controller after {at_controller} parts of 24, a node after {at_node}; {:.1} s",
        start.elapsed().as_secs_f64()
    );
}
