//! A manifest for Kubernetes.

use crate::commands::job::Error;
use crate::output;
use sightlines::checkpoint::Job;
use std::path::PathBuf;

/// Writes an Indexed Job for the shards of a phase into the folder of a job.
pub(in crate::commands::job) fn write_kubernetes(job: &Job, phase: usize) -> Result<PathBuf, Error> {
    let shards = job.manifest().shards_of(phase);
    let path = job.folder().join("kubernetes.yaml");
    let text = format!(
        "# The shards of phase {name} as an Indexed Job of Kubernetes. This file was never tried on a cluster: read it before you apply it.
# Fill in the image with this program, and the claim of a volume that all nodes can write to. The job lies in it under the same path
# as where it was planned, and so do the files of the command. When all pods are done, run `sightlines job merge`;
# if it ends with 3, another phase is to be done: `sightlines job submit --dry-run` writes this file anew.
apiVersion: batch/v1
kind: Job
metadata:
  name: sightlines-{name}
spec:
  completionMode: Indexed
  completions: {n}
  parallelism: {n}
  backoffLimitPerIndex: 2
  template:
    spec:
      restartPolicy: Never
      containers:
        - name: shard
          image: IMAGE
          command:
            - sh
            - -c
            - 'exec sightlines job shard \"$JOB\" \"$((FIRST + JOB_COMPLETION_INDEX))\"'
          env:
            - name: FIRST
              value: \"{first}\"
            - name: JOB
              value: {folder}
          volumeMounts:
            - name: job
              mountPath: {mount}
      volumes:
        - name: job
          persistentVolumeClaim:
            claimName: CLAIM
",
        name = job.manifest().phases[phase].name,
        n = shards.len(),
        first = shards.start,
        // A text of JSON is one of YAML.
        folder = serde_json::Value::from(job.folder().display().to_string()),
        mount = serde_json::Value::from(job.manifest().folder.as_str()),
    );
    output::save(&path, text.as_bytes())?;
    Ok(path)
}
