//! Pages in a real browser, without a window.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Chromium, if it is in the path and shows a page with a scene in space. Otherwise a message says that nothing is opened, and the caller
/// has nothing to test.
pub fn chromium() -> Option<PathBuf> {
    static FOUND: OnceLock<Option<PathBuf>> = OnceLock::new();
    let found = FOUND.get_or_init(|| {
        let path = std::env::var_os("PATH")?;
        let in_path = std::env::split_paths(&path).map(|folder| folder.join("chromium")).find(|file| file.is_file());
        let Some(browser) = in_path else {
            eprintln!("NOT RUN: there is no chromium in the path, so no page is opened");
            return None;
        };
        let told =
            Opened { html: EMPTY, script: HAS_WEBGL, given: &Value::Null, size: [400, 300], link: "" }.open(&browser);
        match told {
            Ok(Value::Bool(true)) => Some(browser),
            Ok(told) => {
                eprintln!("NOT RUN: Chromium has no WebGL 2 here ({told}), so no page is opened");
                None
            }
            Err(error) => {
                eprintln!("NOT RUN: Chromium shows no page here: {error}");
                None
            }
        }
    });
    found.clone()
}

const EMPTY: &str = "<!DOCTYPE html><html><head><meta http-equiv=\"Content-Security-Policy\" content=\"script-src 'sha256-';\"></head>\
                     <body><p>Words</p></body></html>";
const HAS_WEBGL: &str = "tell(document.createElement('canvas').getContext('webgl2') !== null);";

/// A page to be opened with one more script. The script may read `given`, and calls `tell` once with what becomes the result.
#[derive(Debug, Clone, Copy)]
pub struct Opened<'a> {
    /// The page. What its policy forbids stays forbidden, but for this one script.
    pub html: &'a str,
    /// The script.
    pub script: &'a str,
    /// What it may read.
    pub given: &'a Value,
    /// Width and height of the window in pixels.
    pub size: [u32; 2],
    /// What follows `#` in its address, or nothing.
    pub link: &'a str,
}

impl Opened<'_> {
    /// What the script tells.
    ///
    /// # Panics
    /// If the browser does not start, or the script tells nothing.
    pub fn result(&self, browser: &Path) -> Value {
        self.open(browser).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The same, or why there is nothing.
    fn open(&self, browser: &Path) -> Result<Value, String> {
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let page = self.write(folder.path());
        let output = self
            .command(browser, folder.path())
            .args(["--dump-dom", "--virtual-time-budget=60000"])
            .arg(format!("file://{}{}", page.display(), self.link))
            .output()
            .map_err(|error| error.to_string())?;
        let dom = String::from_utf8_lossy(&output.stdout);
        let result = dom.split("<pre id=\"result\" hidden=\"\">").nth(1).and_then(|rest| rest.split("</pre>").next());
        let result = result.ok_or_else(|| format!("no result; {}", String::from_utf8_lossy(&output.stderr)))?;
        let text = result.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
        serde_json::from_str(&text).map_err(|error| error.to_string())
    }

    /// A picture of the page as PNG, after its script.
    ///
    /// # Panics
    /// If the browser does not start, or makes no picture.
    pub fn picture(&self, browser: &Path) -> Vec<u8> {
        let folder = tempfile::tempdir().expect("a folder");
        let (page, picture) = (self.write(folder.path()), folder.path().join("page.png"));
        let output = self
            .command(browser, folder.path())
            .arg("--virtual-time-budget=20000")
            .arg(format!("--screenshot={}", picture.display()))
            .arg(format!("file://{}{}", page.display(), self.link))
            .output()
            .expect("the browser starts");
        std::fs::read(&picture).unwrap_or_else(|_| panic!("no picture; {}", String::from_utf8_lossy(&output.stderr)))
    }

    fn command(&self, browser: &Path, folder: &Path) -> Command {
        let mut command = Command::new(browser);
        command
            .args(["--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking"])
            .args(["--disable-component-update", "--disable-sync", "--enable-unsafe-swiftshader"])
            .args(["--hide-scrollbars", "--force-device-scale-factor=1"])
            .arg(format!("--user-data-dir={}", folder.join("profile").display()))
            .arg(format!("--window-size={},{}", self.size[0], self.size[1]));
        command
    }

    fn write(&self, folder: &Path) -> PathBuf {
        let from = self.html.find("script-src 'sha256-").expect("the policy names the script");
        let to = from + self.html[from..].find(';').expect("the policy goes on");
        let html = format!("{}script-src 'unsafe-inline'{}", &self.html[..from], &self.html[to..]);
        let given = self.given.to_string().replace('<', "\\u003c");
        let more = format!(
            "<script type=\"application/json\" id=\"given\">{given}</script><script>\
             const given = JSON.parse(document.getElementById(\"given\").textContent);\
             const tell = (result) => {{ const out = document.createElement(\"pre\"); out.id = \"result\"; \
             out.hidden = true; out.textContent = JSON.stringify(result); document.body.append(out); }};\
             </script><script>{}</script></body>",
            self.script
        );
        let page = folder.join("page.html");
        std::fs::write(&page, html.replace("</body>", &more)).expect("a file");
        page
    }
}
