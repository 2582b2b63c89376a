//! Which modules of a crate use which, read from its sources. An item that is re-exported counts where it is defined,
//! tests do not count, and neither do methods: what they belong to is not known without types.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use syn::visit::{self, Visit};
use syn::{Attribute, Ident, ItemFn, ItemMod, ItemUse, UseTree, Visibility};

/// A module by its names from the root of the crate, or an item in it.
type Names = Vec<String>;

/// Who uses what of whom: from the first to the second module.
pub(crate) type Arrows = BTreeMap<(Names, Names), BTreeSet<String>>;

#[derive(Default)]
struct Module {
    children: BTreeSet<String>,
    /// Where the names that it re-exports are found.
    exports: BTreeMap<String, Names>,
    uses: BTreeSet<Names>,
    /// Types that it defines.
    types: BTreeSet<String>,
}

/// All modules of a crate.
pub(crate) struct Graph(BTreeMap<Names, Module>);

impl Graph {
    /// The modules below `lib.rs` in a folder.
    pub(crate) fn of_crate(folder: &Path) -> Self {
        let mut graph = Self(BTreeMap::new());
        graph.read(&folder.join("lib.rs"), folder, Vec::new());
        graph
    }

    fn read(&mut self, file: &Path, folder: &Path, names: Names) {
        let code = syn::parse_file(&fs::read_to_string(file).unwrap()).unwrap();
        let mut reader = Reader { names: &names, module: Module::default() };
        reader.find_children(&code);
        reader.find_types(&code);
        reader.visit_file(&code);
        let module = reader.module;
        for child in &module.children {
            let below = folder.join(child);
            let names = [names.as_slice(), std::slice::from_ref(child)].concat();
            let own_file = folder.join(format!("{child}.rs"));
            let file = if own_file.is_file() { own_file } else { below.join("mod.rs") };
            self.read(&file, &below, names);
        }
        self.0.insert(names, module);
    }

    /// The module in which the item of a path is defined, and its name; empty for a module itself.
    fn defined(&self, path: &[String]) -> (Names, String) {
        let mut names = Names::new();
        for (place, name) in path.iter().enumerate() {
            let module = &self.0[&names];
            if module.children.contains(name) {
                names.push(name.clone());
            } else if let Some(target) = module.exports.get(name) {
                return self.defined(&[target, &path[place + 1..]].concat());
            } else {
                return (names, name.clone());
            }
        }
        (names, String::new())
    }

    /// The types of the crate, each with its module.
    pub(crate) fn types(&self) -> impl Iterator<Item = (&String, String)> {
        let modules = self.0.iter().map(|(names, module)| (names.join("::"), &module.types));
        modules.flat_map(|(names, types)| types.iter().map(move |name| (name, names.clone())))
    }

    pub(crate) fn arrows(&self) -> Arrows {
        let mut arrows = Arrows::new();
        for (from, module) in &self.0 {
            for path in &module.uses {
                let (to, item) = self.defined(path);
                if to != *from {
                    arrows.entry((from.clone(), to)).or_default().insert(item);
                }
            }
        }
        arrows
    }
}

/// Reads one file.
struct Reader<'n> {
    names: &'n [String],
    module: Module,
}

impl Reader<'_> {
    fn find_children(&mut self, code: &syn::File) {
        for item in &code.items {
            if let syn::Item::Mod(item) = item
                && item.content.is_none()
                && !is_test(&item.attrs)
            {
                self.module.children.insert(item.ident.to_string());
            }
        }
    }

    fn find_types(&mut self, code: &syn::File) {
        for item in &code.items {
            let (name, attributes) = match item {
                syn::Item::Struct(item) => (&item.ident, &item.attrs),
                syn::Item::Enum(item) => (&item.ident, &item.attrs),
                syn::Item::Trait(item) => (&item.ident, &item.attrs),
                _ => continue,
            };
            if !is_test(attributes) {
                self.module.types.insert(name.to_string());
            }
        }
    }

    /// A path of the own crate from its root; `None` for others.
    fn absolute(&self, path: &[String]) -> Option<Names> {
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => Some(rest.to_vec()),
            "self" => Some([self.names, rest].concat()),
            child if self.module.children.contains(child) => Some([self.names, path].concat()),
            _ => None,
        }
    }

    fn add_use(&mut self, tree: &UseTree, before: &[String], is_export: bool) {
        let with = |ident: &Ident| [before, &[ident.to_string()]].concat();
        match tree {
            UseTree::Path(path) => self.add_use(&path.tree, &with(&path.ident), is_export),
            UseTree::Group(group) => {
                group.items.iter().for_each(|tree| self.add_use(tree, before, is_export));
            }
            UseTree::Name(name) if name.ident == "self" => {
                let own = before.last().unwrap().clone();
                self.add(before, &own, is_export);
            }
            UseTree::Name(name) => {
                self.add(&with(&name.ident), &name.ident.to_string(), is_export);
            }
            UseTree::Rename(name) => {
                self.add(&with(&name.ident), &name.rename.to_string(), is_export);
            }
            UseTree::Glob(_) => self.add(before, "", is_export),
        }
    }

    fn add(&mut self, path: &[String], name: &str, is_export: bool) {
        let Some(path) = self.absolute(path) else { return };
        if is_export {
            self.module.exports.insert(name.to_owned(), path);
        } else {
            self.module.uses.insert(path);
        }
    }
}

impl<'c> Visit<'c> for Reader<'_> {
    fn visit_item_mod(&mut self, item: &'c ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_fn(&mut self, item: &'c ItemFn) {
        if !is_test(&item.attrs) {
            visit::visit_item_fn(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'c ItemUse) {
        if !is_test(&item.attrs) {
            let is_export = !matches!(item.vis, Visibility::Inherited);
            self.add_use(&item.tree, &[], is_export);
        }
    }

    fn visit_path(&mut self, path: &'c syn::Path) {
        let names: Names = path.segments.iter().map(|part| part.ident.to_string()).collect();
        if names.len() > 1
            && let Some(path) = self.absolute(&names)
        {
            self.module.uses.insert(path);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'c syn::Macro) {
        let text = item.tokens.to_string().replace(' ', "");
        for rest in text.split("crate::").skip(1) {
            let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
            let path = rest[..end.unwrap_or(rest.len())].trim_end_matches(':');
            self.module.uses.insert(path.split("::").map(str::to_owned).collect());
        }
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<Ident>().is_ok_and(|word| word == "test")
    })
}

/// Circles within the folders of a crate, in words. The nodes of a folder are its children and `self`, its own file.
pub(crate) fn circles(arrows: &Arrows) -> Vec<String> {
    let mut folders: BTreeMap<&[String], BTreeMap<&str, BTreeSet<&str>>> = BTreeMap::new();
    for (from, to) in arrows.keys() {
        let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        let [from_node, to_node] =
            [from, to].map(|names| names.get(common).map_or("self", String::as_str));
        folders.entry(&from[..common]).or_default().entry(from_node).or_default().insert(to_node);
    }
    let mut found = Vec::new();
    for (folder, edges) in &folders {
        for &start in edges.keys() {
            if let Some(way) = way_back(edges, start)
                && way.iter().all(|node| start <= *node)
            {
                found.push(format!("{}: {} -> {start}", folder.join("::"), way.join(" -> ")));
            }
        }
    }
    found
}

/// A shortest way from a node to itself.
fn way_back<'a>(
    edges: &BTreeMap<&'a str, BTreeSet<&'a str>>,
    start: &'a str,
) -> Option<Vec<&'a str>> {
    let mut ways = std::collections::VecDeque::from([vec![start]]);
    let mut seen = BTreeSet::new();
    while let Some(way) = ways.pop_front() {
        for &next in edges.get(way[way.len() - 1]).into_iter().flatten() {
            if next == start {
                return Some(way);
            }
            if seen.insert(next) {
                ways.push_back([way.as_slice(), &[next]].concat());
            }
        }
    }
    None
}
