//! User actions in a browser.

use crate::protocol::Browser;
use crate::skip;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Names of suitable programs.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// Events by which a page reports an error.
const COMPLAINTS: [&str; 3] =
    ["Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded"];

/// A page that is open.
pub(crate) struct Open(RefCell<Browser>);

/// A key that is held down.
#[derive(Clone, Copy)]
pub(crate) enum Modifier {
    Nothing,
    Ctrl,
}

/// A browser of this machine. Without one the test reports this and ends, unless the environment
/// demands it.
pub(crate) fn find() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path)
        .flat_map(|folder| NAMES.map(|name| folder.join(name)))
        .find(|program| program.is_file());
    if found.is_none() {
        let demanded = std::env::var("LUMIDUCT_BROWSER").is_ok_and(|wish| wish == "required");
        assert!(!demanded, "no browser: none of {NAMES:?} is on the path");
        skip::report(&format!("no browser, none of {NAMES:?} is on the path"));
    }
    found
}

impl Open {
    /// Opens a file.
    pub(crate) fn new(program: &Path, file: &Path) -> Self {
        let mut browser = Browser::new(program);
        for domain in ["Page", "Runtime", "Log"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        browser.call("Page.navigate", json!({ "url": format!("file://{}", file.display()) }));
        browser.expect("Page.loadEventFired");
        Self(RefCell::new(browser))
    }

    /// Sends the browser a command.
    pub(crate) fn call(&self, method: &str, parameters: Value) -> Value {
        self.0.borrow_mut().call(method, parameters)
    }

    /// The value of an expression in the page.
    pub(crate) fn ask(&self, expression: &str) -> Value {
        let wrapped = format!("JSON.stringify({expression}) ?? 'null'");
        let mut answer = self.call("Runtime.evaluate", json!({ "expression": wrapped }));
        let thrown = answer["exceptionDetails"].take();
        assert!(thrown.is_null(), "{expression}: {thrown}");
        serde_json::from_str(answer["result"]["value"].as_str().unwrap()).unwrap()
    }

    /// The same as text.
    pub(crate) fn text(&self, expression: &str) -> String {
        self.ask(expression).as_str().unwrap().to_owned()
    }

    /// Waits until an expression is true: pages draw asynchronously.
    pub(crate) fn expect(&self, expression: &str) {
        let start = Instant::now();
        while self.ask(expression) != Value::Bool(true) {
            assert!(start.elapsed() < Duration::from_secs(5), "never true: {expression}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// A place at a share of the width and height of an element, scrolled into view.
    pub(crate) fn place(&self, element: &str, share: [f64; 2]) -> [f64; 2] {
        let box_of = format!(
            "(() => {{ const e = {element}; e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); \
             const b = e.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; }})()"
        );
        let found = self.ask(&box_of);
        let [left, top, width, height] = [0, 1, 2, 3].map(|i| found[i].as_f64().unwrap());
        [left + share[0] * width, top + share[1] * height]
    }

    /// Moves the pointer over an element.
    pub(crate) fn point_at(&self, element: &str, share: [f64; 2]) {
        self.mouse("mouseMoved", self.place(element, share), "none");
    }

    /// Clicks on an element.
    pub(crate) fn click(&self, element: &str) {
        let at = self.place(element, [0.5, 0.5]);
        self.mouse("mouseMoved", at, "none");
        self.mouse("mousePressed", at, "left");
        self.mouse("mouseReleased", at, "left");
    }

    /// Drags over an element from one place to another.
    pub(crate) fn drag(&self, element: &str, from: [f64; 2], to: [f64; 2]) {
        let start = self.place(element, from);
        let end = self.place(element, to);
        let middle = [0, 1].map(|axis| 0.5 * (start[axis] + end[axis]));
        self.mouse("mousePressed", start, "left");
        self.mouse("mouseMoved", middle, "left");
        self.mouse("mouseMoved", end, "left");
        self.mouse("mouseReleased", end, "left");
    }

    /// Turns the wheel over an element, down by 100 pixels, and waits until the page stops moving.
    pub(crate) fn wheel(&self, element: &str, with: Modifier) {
        let [x, y] = self.place(element, [0.5, 0.5]);
        let modifiers = match with {
            Modifier::Nothing => 0,
            Modifier::Ctrl => 2,
        };
        let event = json!({
            "type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": 100, "modifiers": modifiers,
        });
        self.call("Input.dispatchMouseEvent", event);
        self.rest();
    }

    fn mouse(&self, kind: &str, [x, y]: [f64; 2], button: &str) {
        let buttons = u8::from(button == "left");
        let event = json!({
            "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": buttons,
        });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// The page with a preference for light or dark.
    pub(crate) fn prefer(&self, scheme: &str) {
        let feature = json!({ "name": "prefers-color-scheme", "value": scheme });
        self.call("Emulation.setEmulatedMedia", json!({ "features": [feature] }));
    }

    /// The page in a window of another size, CSS pixels.
    pub(crate) fn resize(&self, width: u32, height: u32) {
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size);
    }

    /// The page on a phone of this size in CSS pixels, with touch input.
    pub(crate) fn on_phone(&self, width: u32, height: u32) {
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 2, "mobile": true });
        self.call("Emulation.setDeviceMetricsOverride", size);
        self.call("Emulation.setTouchEmulationEnabled", json!({ "enabled": true }));
    }

    /// Moves a finger over an element from one place to another, and waits until the page stops
    /// moving.
    pub(crate) fn stroke(&self, element: &str, from: [f64; 2], to: [f64; 2]) {
        const STEPS: u32 = 8;
        let start = self.place(element, from);
        let end = self.place(element, to);
        let touch = |kind: &str, points: Value| {
            self.call("Input.dispatchTouchEvent", json!({ "type": kind, "touchPoints": points }));
        };
        for step in 0..=STEPS {
            let share = f64::from(step) / f64::from(STEPS);
            let [x, y] = [0, 1].map(|axis| start[axis] + share * (end[axis] - start[axis]));
            touch(if step == 0 { "touchStart" } else { "touchMove" }, json!([{ "x": x, "y": y }]));
        }
        touch("touchEnd", json!([]));
        self.rest();
    }

    /// Waits until the page stops scrolling: it coasts for a while after a finger has left it,
    /// which would add to the next scroll.
    fn rest(&self) {
        /// Consecutive looks that must see the page at the same place.
        const LOOKS: usize = 15;
        let start = Instant::now();
        let mut seen = vec![self.ask("scrollY")];
        while seen.len() < LOOKS {
            assert!(start.elapsed() < Duration::from_secs(20), "the page scrolls without end");
            std::thread::sleep(Duration::from_millis(20));
            let now = self.ask("scrollY");
            if now != seen[0] {
                seen.clear();
            }
            seen.push(now);
        }
    }

    /// The page as it is printed to PDF.
    pub(crate) fn print(&self) -> Vec<u8> {
        bytes(&self.call("Page.printToPDF", json!({})))
    }

    /// A picture of what is in view, decoded: width and RGB or RGBA bytes.
    pub(crate) fn picture(&self, keep: &Path) -> Vec<[u8; 3]> {
        let file = bytes(&self.call("Page.captureScreenshot", json!({ "format": "png" })));
        std::fs::write(keep, &file).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        let step = info.color_type.samples();
        pixels.chunks_exact(step).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
    }

    /// Fails if the page has reported an error.
    pub(crate) fn expect_no_complaints(&self) {
        let browser = self.0.borrow();
        let is_complaint = |event: &&Value| COMPLAINTS.iter().any(|name| event["method"] == *name);
        let complaints: Vec<&Value> = browser.events().iter().filter(is_complaint).collect();
        assert!(complaints.is_empty(), "{complaints:#?}");
    }
}

/// The file in a response.
fn bytes(answer: &Value) -> Vec<u8> {
    BASE64_STANDARD.decode(answer["data"].as_str().unwrap()).unwrap()
}
