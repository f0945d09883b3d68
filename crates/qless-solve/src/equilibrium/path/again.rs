//! The second attempt of a load step: from the nearest configuration that satisfies the constraints.

use super::super::Model;
use super::super::correct::{Progress, Way};
use super::super::failure::Failure;
use super::super::rows::Rows;
use super::super::state::Unknowns;
use super::Path;
use super::origin::Nearest;
use super::step::End;
use crate::newton::{NewtonError, NewtonOptions};

impl<M: Model> Path<'_, M> {
    /// Once more with the parts that failed, or with all if the whole model did. Others stay where they are; what is left of the failure of the whole.
    ///
    /// Of two reasons the first counts, which is that of the shorter way, but where the second attempt knows more than that it does not converge, or
    /// there is proof that there is no such configuration.
    pub(super) fn again(
        &mut self,
        x: &mut Unknowns,
        all: &mut Vec<Progress>,
        whole: Option<Failure>,
        end: &End,
    ) -> Option<Failure> {
        let Ok(mut found) = self.consistent(&end.prescribed, NewtonOptions::default().steps) else { return whole };
        match whole {
            None => self.parts_again(x, all, found, end),
            Some(whole) => {
                let proof = |error: &Option<NewtonError>| matches!(error, Some(NewtonError::Conflict { .. }));
                if let Some(part) = found.errors.iter().position(proof) {
                    return found.errors[part].take().map(Failure::Constraints);
                }
                self.all_again(x, all, (whole, found), end)
            }
        }
    }

    fn parts_again(
        &mut self,
        x: &mut Unknowns,
        all: &mut [Progress],
        mut found: Nearest,
        end: &End,
    ) -> Option<Failure> {
        let mut retried = Vec::new();
        for (part, own) in all.iter_mut().enumerate().filter(|(_, own)| own.may_start_again()) {
            match found.errors[part].take() {
                Some(proof @ NewtonError::Conflict { .. }) => own.way = Way::Failed(Failure::Constraints(proof)),
                None if self.is_elsewhere(part, &found.u, end) => retried.push(part),
                _ => (),
            }
        }
        if retried.is_empty() {
            return None;
        }
        let before = x.clone();
        self.put(x, &retried, &found.u, end);
        let choice = match self.choice_at(&x.u, &end.prescribed) {
            Ok(choice) => choice,
            Err(failure) => return Some(failure),
        };
        let other = |&part: &usize| {
            let rows = Rows::new(&self.parts.list[part].rows, &choice);
            (part, std::mem::replace(&mut all[part], Progress::new(rows)))
        };
        let firsts: Vec<_> = retried.iter().map(other).collect();
        let second = self.attempt((x, Some(before)), all, end).err();
        for (part, first) in firsts {
            if let Way::Failed(Failure::NoConvergence) = all[part].way {
                all[part].way = first.way;
            }
        }
        second
    }

    fn all_again(
        &mut self,
        x: &mut Unknowns,
        all: &mut Vec<Progress>,
        (whole, found): (Failure, Nearest),
        end: &End,
    ) -> Option<Failure> {
        let every = 0..self.parts.count();
        let there = every.filter(|&part| found.errors[part].is_none());
        let retried: Vec<usize> = there.filter(|&part| self.is_elsewhere(part, &found.u, end)).collect();
        if retried.is_empty() {
            return Some(whole);
        }
        *x = self.at.clone();
        self.put(x, &retried, &found.u, end);
        let choice = match self.choice_at(&x.u, &end.prescribed) {
            Ok(choice) => choice,
            Err(failure) => return Some(failure),
        };
        *all = self.parts.list.iter().map(|part| Progress::new(Rows::new(&part.rows, &choice))).collect();
        let second = self.attempt((x, None), all, end).err();
        let knows_more = |own: &Progress| !matches!(own.way, Way::Failed(Failure::NoConvergence));
        if second.is_none() && !all.iter().all(knows_more) { Some(whole) } else { second }
    }

    /// Whether a part is not where it was.
    fn is_elsewhere(&self, part: usize, u: &[f64], end: &End) -> bool {
        let (part, at) = (&self.parts.list[part], &self.at.u);
        part.free.iter().any(|&j| u[j] != at[j]) || part.held.iter().any(|&j| end.goal[j] != Some(at[j]))
    }

    /// Puts parts to u, and prescribed DOFs to their values.
    fn put(&self, x: &mut Unknowns, parts: &[usize], u: &[f64], end: &End) {
        for part in parts.iter().map(|&part| &self.parts.list[part]) {
            part.free.iter().for_each(|&j| x.u[j] = u[j]);
            part.rows.iter().for_each(|&r| x.multipliers[r] = self.at.multipliers[r]);
        }
        end.prescribed.iter().for_each(|&(j, v)| x.u[j] = v);
    }
}
