//! The remote control of Chromium: commands and events as JSON over a socket (the `DevTools` protocol of Chrome).

use serde_json::{Value, json};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

/// No window, no sandbox (unavailable in containers), no graphics card, no network, no first-run
/// dialogs. The system chooses the port.
const ARGUMENTS: [&str; 11] = [
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--disable-component-update",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--mute-audio",
    "--no-first-run",
    "--window-size=1400,1000",
    "--remote-debugging-port=0",
];
/// How long a browser may take to start, or to answer.
const PATIENCE: Duration = Duration::from_secs(30);

/// A browser with one page.
pub(crate) struct Browser {
    program: Child,
    socket: WebSocket<TcpStream>,
    /// The page that commands are for.
    session: Option<String>,
    last_command: u64,
    /// Everything it has reported unasked.
    events: Vec<Value>,
    // Removed when the browser has ended.
    _profile: TempDir,
}

impl Browser {
    /// Starts a browser with an empty page.
    pub(crate) fn new(program: &Path) -> Self {
        let profile = tempfile::tempdir().unwrap();
        let mut program = Command::new(program)
            .args(ARGUMENTS)
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let (port, place) = address(&mut program, profile.path());
        let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let url = format!("ws://127.0.0.1:{port}{place}");
        let (socket, _) = tungstenite::client(url, stream).unwrap();
        let (session, events) = (None, Vec::new());
        let mut browser =
            Self { program, socket, session, last_command: 0, events, _profile: profile };
        let page = browser.call("Target.createTarget", json!({ "url": "about:blank" }));
        let page = json!({ "targetId": page["targetId"], "flatten": true });
        let session = browser.call("Target.attachToTarget", page);
        browser.session = session["sessionId"].as_str().map(str::to_owned);
        browser
    }

    /// Gives a command and waits for its answer.
    pub(crate) fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.last_command += 1;
        let mut command =
            json!({ "id": self.last_command, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            command["sessionId"] = json!(session);
        }
        self.socket.send(Message::text(command.to_string())).unwrap();
        loop {
            let mut message = self.next();
            if message["id"] == json!(self.last_command) {
                assert!(message.get("error").is_none(), "{method}: {}", message["error"]);
                return message["result"].take();
            }
            self.events.push(message);
        }
    }

    /// Waits for an event.
    pub(crate) fn expect(&mut self, method: &str) {
        while !self.events.iter().any(|event| event["method"] == method) {
            let message = self.next();
            self.events.push(message);
        }
    }

    /// Everything it has reported unasked so far.
    pub(crate) fn events(&self) -> &[Value] {
        &self.events
    }

    fn next(&mut self) -> Value {
        loop {
            // A browser that no longer answers fails the test.
            if let Message::Text(text) = self.socket.read().unwrap() {
                return serde_json::from_str(&text).unwrap();
            }
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        _ = self.program.kill();
        _ = self.program.wait();
    }
}

/// Port and path at which a browser listens; it writes them into its folder once it does.
fn address(program: &mut Child, profile: &Path) -> (u16, String) {
    let start = Instant::now();
    loop {
        let text = std::fs::read_to_string(profile.join("DevToolsActivePort")).unwrap_or_default();
        if let Some((port, place)) = text.split_once('\n')
            && !place.is_empty()
        {
            return (port.parse().unwrap(), place.trim().to_owned());
        }
        assert!(program.try_wait().unwrap().is_none(), "the browser has ended");
        assert!(start.elapsed() < PATIENCE, "the browser does not start");
        std::thread::sleep(Duration::from_millis(20));
    }
}
