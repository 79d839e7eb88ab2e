//! Nodes, elements and sets.

use super::non_solids;
use super::{Reader, at_most, known, label, named, number_or_zero, options, whole};
use crate::data::{ElementBlock, Label};
use crate::error::{DeckError, quote};
use crate::lexer::{Data, Keyword};
use gearbench_solid_fe::Vec3;
use gearbench_solid_fe::mesh::ElementKind;
use std::collections::HashSet;

/// Members of a set.
#[derive(Clone, Copy)]
enum SetKind {
    Nodes,
    Elements,
}

impl Reader<'_> {
    pub(super) fn heading(&mut self) -> Result<(), DeckError> {
        while let Some(data) = self.lexer.data()? {
            self.deck.heading.push(data.fields.join(", "));
        }
        Ok(())
    }

    pub(super) fn node(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [set] = options(k, ["NSET"], &[])?;
        let set = set.map(|s| named(k, "NSET", Some(s))).transpose()?;
        let mut new = Vec::new();
        while let Some(data) = self.lexer.data()? {
            // Three more are the normal of a shell.
            at_most(k, &data, 7)?;
            let label = label(k, &data, field(&data, 0))?;
            let x = Vec3::new(
                number_or_zero(k, &data, 1)?,
                number_or_zero(k, &data, 2)?,
                number_or_zero(k, &data, 3)?,
            );
            let (dense, new_label) = self.deck.node_labels.insert_full(label.into());
            if !new_label {
                return Err(data.reference(
                    k,
                    "each node once",
                    format!("label {label} again"),
                    "renumber one of them",
                ));
            }
            self.deck.nodes.push(x);
            new.push(dense as u32);
        }
        if let Some(set) = set {
            self.extend(k, SetKind::Nodes, set, new);
        }
        Ok(())
    }

    pub(super) fn element(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [kind, set] = options(k, ["TYPE", "ELSET"], &[])?;
        let name = named(k, "TYPE", kind)?.to_ascii_uppercase();
        let set = set.map(|s| named(k, "ELSET", Some(s))).transpose()?;
        let members = match (non_solids::solid(&name), non_solids::nodes_of_other(&name)) {
            (Some(kind), _) => self.solids(k, &name, kind, set.clone())?,
            (None, Some(nodes)) => self.other_elements(k, &name, nodes)?,
            (None, None) => {
                let known = ElementKind::ALL.map(ElementKind::name).join(", ");
                return Err(k.unsupported(
                    format!("an element among {known}"),
                    quote(&name),
                    "mesh the gear with these solids",
                ));
            }
        };
        if let Some(set) = set {
            self.extend(k, SetKind::Elements, set, members);
        }
        Ok(())
    }

    /// The elements of a solid kind, as a block; gives their numbers.
    fn solids(
        &mut self,
        k: &Keyword,
        name: &str,
        kind: ElementKind,
        set: Option<String>,
    ) -> Result<Vec<u32>, DeckError> {
        let first = self.deck.element_labels.len() as u32;
        let mut block = ElementBlock {
            kind,
            set,
            first,
            connectivity: Vec::new(),
            place: k.place.clone(),
        };
        let mut beyond = 0;
        while let Some(data) = self.lexer.data()? {
            let label = self.new_label(k, &data)?;
            self.deck.element_labels.insert(label);
            beyond += self.nodes_of(k, data, kind.nodes(), &mut block.connectivity)?;
        }
        let end = self.deck.element_labels.len() as u32;
        if end > first {
            self.deck.blocks.push(block);
        }
        if name != kind.name() && end > first {
            let words = format!("{name} is read as {}", kind.name());
            *self.deck.others.taken.entry(words).or_default() += end - first;
        }
        if beyond > 0 {
            let words = format!(
                "values after the {} nodes of {name} are ignored",
                kind.nodes()
            );
            *self.deck.others.taken.entry(words).or_default() += beyond;
        }
        Ok((first..end).collect())
    }

    /// Returns the label of an element, which has to be a new one.
    pub(super) fn new_label(&self, k: &Keyword, data: &Data) -> Result<Label, DeckError> {
        let number = label(k, data, field(data, 0))?;
        match self.deck.any_element(number.into()) {
            None => Ok(number.into()),
            Some(_) => Err(data.reference(
                k,
                "each element once",
                format!("label {number} again"),
                "renumber one of them",
            )),
        }
    }

    /// Nodes of an element, over as many lines as it takes; gives 1 when the last line has further values, which
    /// programs pass over.
    fn nodes_of(
        &mut self,
        k: &Keyword,
        mut data: Data,
        count: usize,
        out: &mut Vec<u32>,
    ) -> Result<u32, DeckError> {
        let label = field(&data, 0).to_owned();
        let start = out.len();
        let mut skip = 1;
        loop {
            let fields = data.fields.get(skip..).unwrap_or_default();
            let missing = count - (out.len() - start);
            for text in fields.iter().take(missing) {
                let node = self.node_at(k, &data, text)?;
                out.push(node);
            }
            let found = out.len() - start;
            if found == count {
                let own = &mut out[start..].to_vec();
                own.sort_unstable();
                if own.windows(2).any(|w| w[0] == w[1]) {
                    return Err(data.unsupported(
                        k,
                        format!("{count} different nodes of element {label}"),
                        "one of them twice",
                        "a collapsed hexahedron is a wedge: write it as C3D6 or C3D15",
                    ));
                }
                return Ok(u32::from(fields.len() > missing));
            }
            let Some(more) = self.lexer.data()? else {
                return Err(data.syntax(
                    k,
                    format!("{count} nodes of element {label}"),
                    found.to_string(),
                    "an element continues in the next line until it has all its nodes",
                ));
            };
            (data, skip) = (more, 0);
        }
    }

    pub(super) fn nset(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let [set, generate, instance, elements] = options(
            k,
            ["NSET", "GENERATE", "INSTANCE", "ELSET"],
            // The last is an option of output requests: CalculiX passes it over here.
            &["INTERNAL", "UNSORTED", "FREQUENCY"],
        )?;
        let set = named(k, "NSET", set)?;
        let instance = self.named_instance(k, instance)?;
        if let Some(elements) = elements {
            self.outside_step(k)?;
            let name = self.of_instance(instance, elements);
            known(
                &k.place,
                &k.text,
                "element set",
                &name,
                &self.deck.element_sets,
            )?;
            let of = self.deck.element_sets[&name].iter();
            let nodes = of.flat_map(|&e| self.deck.nodes_of_any(e)).copied();
            let nodes: Vec<u32> = nodes.collect();
            self.extend(k, SetKind::Nodes, set, nodes);
            return Ok(());
        }
        let members = self.members(k, SetKind::Nodes, generate.is_some(), instance)?;
        self.extend(k, SetKind::Nodes, set, members);
        Ok(())
    }

    pub(super) fn elset(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let [set, generate, instance] = options(
            k,
            ["ELSET", "GENERATE", "INSTANCE"],
            &["INTERNAL", "UNSORTED"],
        )?;
        let set = named(k, "ELSET", set)?;
        let instance = self.named_instance(k, instance)?;
        let members = self.members(k, SetKind::Elements, generate.is_some(), instance)?;
        self.extend(k, SetKind::Elements, set, members);
        Ok(())
    }

    /// Returns the name of a set, qualified by an instance if one is given.
    pub(super) fn of_instance(&self, instance: u32, name: &str) -> String {
        let name = name.to_ascii_lowercase();
        match (instance as usize).checked_sub(1) {
            Some(i) => format!("{}.{name}", self.deck.instances[i]),
            None => name,
        }
    }

    /// The data lines of a set: labels, names of sets, or ranges.
    fn members(
        &mut self,
        k: &Keyword,
        of: SetKind,
        generate: bool,
        instance: u32,
    ) -> Result<Vec<u32>, DeckError> {
        self.outside_step(k)?;
        let mut members = Vec::new();
        let mut taken: HashSet<String> = HashSet::new();
        while let Some(data) = self.lexer.data()? {
            if generate {
                self.range(k, of, &data, instance, &mut members)?;
                continue;
            }
            for text in &data.fields {
                if text.is_empty() {
                    continue;
                }
                if self.is_label(text) {
                    members.push(self.member(k, of, &data, text, instance)?);
                    continue;
                }
                let name = self.of_instance(instance, text);
                let (what, sets) = match of {
                    SetKind::Nodes => ("node set", &self.deck.node_sets),
                    SetKind::Elements => ("element set", &self.deck.element_sets),
                };
                known(&data.place, &k.text, what, &name, sets)?;
                // A set named a hundred times adds its members once: a deck cannot grow by repetition.
                if !taken.contains(&name) {
                    members.extend_from_slice(&sets[&name]);
                    taken.insert(name);
                }
            }
        }
        Ok(members)
    }

    fn member(
        &self,
        k: &Keyword,
        of: SetKind,
        data: &Data,
        text: &str,
        instance: u32,
    ) -> Result<u32, DeckError> {
        match of {
            SetKind::Nodes => self.node_in(k, data, text, instance),
            SetKind::Elements => self.element_in(k, data, text, instance),
        }
    }

    /// `first, last, increment`, all of which have to be defined.
    fn range(
        &self,
        k: &Keyword,
        of: SetKind,
        data: &Data,
        instance: u32,
        members: &mut Vec<u32>,
    ) -> Result<(), DeckError> {
        at_most(k, data, 3)?;
        let first = label(k, data, field(data, 0))?;
        let last = match field(data, 1) {
            "" => first,
            text => label(k, data, text)?,
        };
        let step = match data.fields.get(2) {
            Some(text) => whole(k, data, text, "an increment from 1")?,
            None => 1,
        };
        if last < first {
            return Err(data.syntax(
                k,
                "first label, last label, increment",
                format!("{first} to {last}"),
                "put the smaller label first",
            ));
        }
        let place = |number: u32| {
            let label = Label { instance, number };
            match of {
                SetKind::Nodes => self.deck.node_labels.get_index_of(&label).map(|n| n as u32),
                SetKind::Elements => self.deck.any_element(label),
            }
        };
        // Ranges may have gaps. Never more steps than the deck has labels.
        let known = match of {
            SetKind::Nodes => self.deck.node_labels.len(),
            SetKind::Elements => self.deck.element_labels.len() + self.deck.others.elements.len(),
        };
        let before = members.len();
        let steps = (last - first) / step;
        if steps as usize <= 4 * known {
            let labels = (0..=steps).map(|i| first + i * step);
            members.extend(labels.filter_map(place));
        } else {
            let labels = match of {
                SetKind::Nodes => &self.deck.node_labels,
                SetKind::Elements => &self.deck.element_labels,
            };
            let within = |l: &&Label| {
                l.instance == instance
                    && (first..=last).contains(&l.number)
                    && (l.number - first).is_multiple_of(step)
            };
            members.extend(labels.iter().filter(within).filter_map(|l| place(l.number)));
        }
        if members.len() > before {
            return Ok(());
        }
        Err(data.reference(
            k,
            format!("some of {first} to {last} by {step} defined above"),
            "none of them",
            "generate existing labels",
        ))
    }

    /// Adds to a set, each member once.
    fn extend(&mut self, k: &Keyword, of: SetKind, name: String, members: Vec<u32>) {
        let sets = match of {
            SetKind::Nodes => &mut self.deck.node_sets,
            SetKind::Elements => &mut self.deck.element_sets,
        };
        let place = || k.place.clone();
        self.deck.defined.entry(name.clone()).or_insert_with(place);
        let set = sets.entry(name).or_default();
        let mut seen: HashSet<u32> = set.iter().copied().collect();
        set.extend(members.into_iter().filter(|m| seen.insert(*m)));
    }
}

/// Returns a field of a data line; a missing one is empty.
pub(super) fn field(data: &Data, i: usize) -> &str {
    data.fields.get(i).map_or("", String::as_str)
}

/// Returns the error of a second definition.
pub(super) fn twice(k: &Keyword, what: &str, name: &str) -> DeckError {
    k.reference(
        format!("each {what} once"),
        format!("{} again", quote(name)),
        "rename one of them",
    )
}
