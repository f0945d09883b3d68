//! Rows of T of any DOFs, asked of their owners.

use super::Lines;
use crate::parts::Layout;
use crate::ranks::{Message, Post, Ranks};

/// The rows of those of `dofs` (ascending) that are slaves; `lines` are those of the slaves that this rank owns. Collective.
pub(crate) fn ask(ranks: &dyn Ranks, layout: &Layout, lines: &Lines, dofs: &[u64]) -> Lines {
    let own = layout.owned(ranks.rank());
    let mut post = Post::default();
    dofs.iter().filter(|dof| !own.contains(dof)).for_each(|&dof| post.to(layout.owner(dof)).push(dof));
    let answer = |message: Message| {
        let mut words = Vec::new();
        message.words.iter().filter_map(|&dof| lines.find(dof)).for_each(|line| line.write(&mut words));
        Message { rank: message.rank, words }
    };
    let answers = post.send(ranks).into_iter().map(answer).filter(|message| !message.words.is_empty()).collect();
    let mut found = Lines::default();
    lines.among(dofs).for_each(|line| found.push_line(line));
    ranks.exchange(answers).iter().for_each(|message| found.read(&message.words));
    found
}
