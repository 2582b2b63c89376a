//! `report.md`: the page for Markdown viewers.

use crate::Report;
use crate::contents::{parts, verdict};
use crate::output::{LOGO, Pictures};
use crate::page::{Block, PagePart, Plots};
use lumiduct_base::text::{markdown_cell, markdown_page};
use lumiduct_input::Project;
use std::fmt::Write;

/// The whole page.
pub(crate) fn markdown(report: &Report, pictures: Pictures) -> String {
    let mut page = format!("# {}\n\n", report.scene.title);
    page += &masthead(report.scene.project.as_ref());
    if let Some(description) = &report.scene.description {
        page += &format!("{}\n\n", description.trim());
    }
    let (_, verdict) = verdict(report);
    page += &format!("**{verdict}**\n\n");
    if report.run.partial {
        page += "**This report is partial: the run was interrupted.**\n\n";
    }
    // Plots need scripts; Markdown shows their pictures.
    for mut part in parts(report, &mut Plots::default()) {
        let is_empty = |block: &Block| matches!(block, Block::Table { rows, folded: None, .. } if rows.is_empty());
        let is_plot = |block: &Block| matches!(block, Block::Plot { .. } | Block::PlotRow { .. });
        part.blocks.retain(|block| !is_empty(block));
        match pictures {
            Pictures::Drawn => {}
            Pictures::LeftOut => part.blocks.retain(|block| !is_plot(block)),
        }
        add(&mut page, &part, usize::MAX);
    }
    markdown_page(page.trim_end()) + "\n"
}

/// The head of the pages of a project.
pub(crate) fn masthead(project: Option<&Project>) -> String {
    let Some(project) = project else { return String::new() };
    let logo = if project.logo.is_some() { format!("![logo]({LOGO})\n\n") } else { String::new() };
    let lines = project.entries().into_iter().map(|(name, text)| format!("{name}: {text}"));
    format!("{logo}{}\n\n", lines.collect::<Vec<_>>().join(" · "))
}

/// Adds a part, with up to this many rows of each table.
pub(crate) fn add(page: &mut String, part: &PagePart, most_rows: usize) {
    _ = write!(page, "## {}\n\n", part.title);
    add_blocks(page, &part.blocks, most_rows);
}

fn add_blocks(page: &mut String, blocks: &[Block], most_rows: usize) {
    for block in blocks {
        match block {
            Block::Heading { text } => _ = write!(page, "### {text}\n\n"),
            Block::Words { text } => _ = write!(page, "{text}\n\n"),
            Block::List { items } => {
                items.iter().for_each(|item| page.push_str(&format!("- {item}\n")));
                page.push('\n');
            }
            Block::Table { folded: Some(what), .. } => {
                _ = write!(page, "{what} are in `measures.csv`.\n\n");
            }
            Block::Table { head, rows, folded: None } => table(page, head, rows, most_rows),
            Block::Plot { label, picture: Some(picture), .. } => {
                _ = write!(page, "![{label}]({picture})\n\n");
            }
            Block::Plot { picture: None, .. } => {}
            Block::PlotRow { plots } => add_blocks(page, plots, most_rows),
        }
    }
}

fn table(page: &mut String, head: &[String], rows: &[Vec<String>], most: usize) {
    let mut line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| markdown_cell(cell)).collect();
        _ = writeln!(page, "| {} |", cells.join(" | "));
    };
    line(head);
    line(&vec!["---".to_owned(); head.len()]);
    rows.iter().take(most).for_each(|row| line(row));
    if rows.len() > most {
        _ = write!(page, "\n{} more rows are in `study.html`.\n", rows.len() - most);
    }
    page.push('\n');
}
