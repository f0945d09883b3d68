//! Looks up sets of nodes and of elements, and fields that hold a number or the name of a set.

use std::rc::Rc;

use rustc_hash::FxHashSet;

use crate::deck::Problem;
use crate::deck::calculix::model::{DeckDefinitions, ParsedSet, SetMembers, SetPart, folded};
use crate::deck::calculix::syntax::parameters::undefined;
use crate::deck::calculix::syntax::{DataLines, Scope, fold_name, number};
use crate::deck::limits::MEMBERS;
use crate::fault::quote;

impl DeckDefinitions {
    /// The number in the deck of the node that has the number `own` in a scope.
    pub fn numbered(&self, scope: Scope, own: u32) -> Result<u32, Problem> {
        if self.instances.is_empty() {
            return Ok(own);
        }
        let undefined = || {
            let instance = (scope.0 as usize).checked_sub(1).and_then(|k| self.instances.get(k));
            let name = instance.map_or_else(|| own.to_string(), |instance| format!("{}.{own}", instance.name));
            Problem::Undefined { what: "node", name }
        };
        self.numbers()?.get(scope, own).ok_or_else(undefined)
    }

    /// The node that a field names, by a number, or by an instance and a number in it.
    pub fn node(&self, scope: Scope, field: &[u8]) -> Result<u32, Problem> {
        self.by_number(scope, field).unwrap_or_else(|| number(field, "a node"))
    }

    /// The node that a field names by a number, or by an instance and a number in it; `None` for any other field.
    pub fn by_number(&self, scope: Scope, field: &[u8]) -> Option<Result<u32, Problem>> {
        let own = number(field, "a node").ok().map(|own| (scope, own));
        own.or_else(|| self.of_instance(field)).map(|(scope, own)| self.numbered(scope, own))
    }

    /// Splits `I.12`, where I is the name of an instance, into the scope of I and the number 12.
    fn of_instance(&self, field: &[u8]) -> Option<(Scope, u32)> {
        if self.instances.is_empty() {
            return None;
        }
        let text = folded(field);
        let (scope, rest) = self.qualified(&text)?;
        Some((scope, number(rest.as_bytes(), "a number").ok()?))
    }

    /// The node that a field names. If the field names a set, this must have only one node.
    pub fn one_node(&self, scope: Scope, field: &[u8]) -> Result<u32, Problem> {
        match self.node_or_set(scope, field)?[..] {
            [node] => Ok(node),
            ref nodes => {
                let found = quote(format!("{} with {} nodes", String::from_utf8_lossy(field), nodes.len()).as_bytes());
                Err(Problem::Expected { expected: "a node, or a set of one node", found })
            }
        }
    }

    /// The node that a field names, or the nodes of the set that it names.
    pub fn node_or_set(&self, scope: Scope, field: &[u8]) -> Result<Vec<u32>, Problem> {
        match self.by_number(scope, field) {
            Some(node) => Ok(vec![node?]),
            None => self.nodes(scope, &String::from_utf8_lossy(field)).map(|nodes| nodes.to_vec()),
        }
    }

    /// The element that a field names, or the elements of the set that it names, as indices into
    /// [`MeshElements`](crate::deck::calculix::model::elements::MeshElements).
    pub fn element_or_set(&self, scope: Scope, field: &[u8]) -> Result<Vec<u32>, Problem> {
        match number(field, "an element").ok().map(|own| (scope, own)).or_else(|| self.of_instance(field)) {
            Some((scope, own)) => Ok(vec![self.elements()?.index(scope, own)?]),
            None => self.members(true, scope, &folded(field)).map(|elements| elements.to_vec()),
        }
    }

    /// The nodes of a node set, each once. They ascend in Abaqus, unless the set is unsorted; otherwise they are in the order of its definition.
    pub fn nodes(&self, scope: Scope, set: &str) -> Result<Rc<Vec<u32>>, Problem> {
        self.members(false, scope, &fold_name(set))
    }

    /// The nodes of all elements of an element set, ascending, each once.
    pub fn nodes_of(&self, scope: Scope, elements: &str) -> Result<Vec<u32>, Problem> {
        let mut nodes = Vec::new();
        for &element in self.members(true, scope, &fold_name(elements))?.iter() {
            nodes.extend_from_slice(self.elements()?.nodes(element));
        }
        nodes.sort_unstable();
        nodes.dedup();
        Ok(nodes)
    }

    fn members(&self, of_elements: bool, scope: Scope, set: &str) -> Result<Rc<Vec<u32>>, Problem> {
        let what = if of_elements { "element set" } else { "node set" };
        let parts = self.find(if of_elements { &self.sets.of_elements } else { &self.sets.of_nodes }, scope, set);
        let named = if of_elements { self.find(&self.elements()?.by_set, scope, set) } else { None };
        let key = match (&parts, &named) {
            (Some((key, _)), _) | (None, Some((key, _))) => (of_elements, key.clone()),
            (None, None) => return Err(undefined(what, set.to_owned())),
        };
        match self.sets.known.borrow().get(&key) {
            Some(ParsedSet::Done(members)) => return Ok(Rc::clone(members)),
            Some(ParsedSet::InProgress) => return Err(Problem::Circular { what, name: set.to_owned() }),
            None => {}
        }
        self.sets.known.borrow_mut().insert(key.clone(), ParsedSet::InProgress);
        let mut members = named.map(|(_, members)| members.clone()).unwrap_or_default();
        let parts = parts.map_or(&[][..], |(_, parts)| parts.as_slice());
        let added = parts.iter().try_for_each(|part| self.add_members(part, of_elements, &mut members));
        if let Err(problem) = added {
            // The set is not defined by itself: another card finds the same problem.
            self.sets.known.borrow_mut().remove(&key);
            return Err(problem);
        }
        let mut seen = FxHashSet::default();
        members.retain(|&member| seen.insert(member));
        if self.is_abaqus && !parts.iter().any(|part| part.is_unsorted) {
            members.sort_unstable();
        }
        let members = Rc::new(members);
        self.sets.known.borrow_mut().insert(key, ParsedSet::Done(Rc::clone(&members)));
        Ok(members)
    }

    fn add_members(&self, set: &SetPart, of_elements: bool, members: &mut Vec<u32>) -> Result<(), Problem> {
        let scope = match &set.instance {
            // A deck without instances may still have `INSTANCE=` on a card; ccx ignores it.
            Some(instance) if !self.instances.is_empty() => *self
                .by_instance
                .get(instance)
                .ok_or_else(|| Problem::Undefined { what: "instance", name: instance.clone() })?,
            _ => set.scope,
        };
        match &set.part {
            SetMembers::Lines(pieces) => {
                for line in DataLines::new(pieces) {
                    members.push(self.node(scope, line.fields().next().unwrap_or_default())?);
                }
            }
            SetMembers::List(pieces) => {
                for field in DataLines::new(pieces).flat_map(|line| line.fields()).filter(|field| !field.is_empty()) {
                    if of_elements {
                        members.extend(self.element_or_set(scope, field)?);
                    } else if let Some(node) = self.by_number(scope, field) {
                        members.push(node?);
                    } else {
                        members.extend_from_slice(&self.nodes(scope, &String::from_utf8_lossy(field))?);
                    }
                }
            }
            SetMembers::Generate(pieces) => {
                for line in DataLines::new(pieces) {
                    self.generate(&mut line.fields(), of_elements, scope, members)?;
                }
            }
            SetMembers::Unknown(card) => {
                return Err(Problem::NotFollowed { what: format!("a set that {card} gives members") });
            }
            SetMembers::OfElements(set) => members.extend(self.nodes_of(scope, set)?),
        }
        Ok(())
    }

    /// Adds the members of the range `first, last, increment`. Elements that do not exist are left out. Nodes that do not exist are left
    /// out only if the deck has instances.
    fn generate<'a>(
        &self,
        fields: &mut impl Iterator<Item = &'a [u8]>,
        of_elements: bool,
        scope: Scope,
        members: &mut Vec<u32>,
    ) -> Result<(), Problem> {
        let mut next = || fields.next().filter(|field| !field.is_empty());
        let first = number(next().unwrap_or_default(), "the first member of a range")?;
        let last = next().map_or(Ok(first), |field| number(field, "the last member of a range"))?;
        let step = next().map_or(Ok(1), |field| number(field, "an increment"))?;
        if step == 0 || last < first {
            let found = quote(format!("{first}, {last}, {step}").as_bytes());
            return Err(Problem::Expected { expected: "an ascending range with an increment of at least 1", found });
        }
        if members.len() + ((last - first) / step) as usize >= MEMBERS {
            return Err(Problem::Limit { what: "the size of a set", limit: MEMBERS, advice: "correct the range" });
        }
        let range = (first..=last).step_by(step as usize);
        if of_elements {
            let elements = self.elements()?;
            members.extend(range.filter_map(|own| elements.index(scope, own).ok()));
        } else if self.instances.is_empty() {
            members.extend(range);
        } else {
            let numbers = self.numbers()?;
            members.extend(range.filter_map(|own| numbers.get(scope, own)));
        }
        Ok(())
    }
}
