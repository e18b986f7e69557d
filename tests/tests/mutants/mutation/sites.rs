//! The sites of a drive: a value goes in, and the value in force comes out.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, HashSet};
use std::hash::{DefaultHasher, Hasher};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use lashloop_protocol::enums::{FaultCode, Outcome, State};

use super::{Checks, Key, Memory, Mutant, Value, Width};

/// The sites of one drive: those of an unchanged one, of a mutant, or of one under record.
pub struct Sites {
    pub state: Cell<State>,
    mutant: Option<Mutant>,
    memory: RefCell<Memory>,
    recorder: Option<Arc<Recorder>>,
}

/// Every site that an unchanged drive reaches, with the checks in which each mutant there would act.
#[derive(Default)]
pub struct Recorder {
    /// Number of the check under way; 0 is the handshake before the first.
    pub check: AtomicUsize,
    sites: Mutex<BTreeMap<Key, Vec<Probe>>>,
}

struct Probe {
    mutant: Mutant,
    memory: Memory,
    acts_in: Checks,
    /// Of all values, so that two mutants with the same ones count as one.
    trace: DefaultHasher,
    /// The first value.
    value: Value,
}

impl Recorder {
    /// Every mutant that acts at all, and where.
    pub fn mutants(&self) -> Vec<(Mutant, Checks)> {
        let sites = self.sites.lock().unwrap_or_else(PoisonError::into_inner);
        let mut mutants = Vec::new();
        for (key, probes) in &*sites {
            let mut traces = HashSet::new();
            let acting = probes.iter().filter(|it| !it.acts_in.is_empty());
            let different = acting.filter(|it| traces.insert((key, it.trace.finish())));
            mutants.extend(different.map(|it| (it.mutant, it.acts_in.clone())));
        }
        mutants
    }

    fn record(&self, key: Key, state: State, value: &Value) {
        let check = self.check.load(Ordering::Relaxed);
        let mut sites = self.sites.lock().unwrap_or_else(PoisonError::into_inner);
        let probes = sites.entry(key).or_insert_with(|| {
            let probe = |mutant| Probe {
                mutant,
                memory: Memory::default(),
                acts_in: Checks::new(),
                trace: DefaultHasher::new(),
                value: value.clone(),
            };
            Mutant::all_at(key, value).into_iter().map(probe).collect()
        });
        for probe in probes {
            assert!(probe.value.is_like(value), "{key:?} is the name of two sites");
            let mutated = probe.mutant.apply(&mut probe.memory, state, value);
            mutated.hash(&mut probe.trace);
            if !mutated.is(value) {
                probe.acts_in.insert(check);
            }
        }
    }

    fn restart(&self) {
        let mut sites = self.sites.lock().unwrap_or_else(PoisonError::into_inner);
        sites.values_mut().flatten().for_each(|probe| probe.memory = Memory::default());
    }
}

impl Sites {
    pub fn new(mutant: Option<Mutant>, recorder: Option<Arc<Recorder>>) -> Self {
        Self { state: Cell::new(State::Boot), mutant, memory: RefCell::default(), recorder }
    }

    /// After a power-up, so that a mutant that is wrong once is wrong in every check.
    pub fn restart(&self) {
        self.memory.take();
        if let Some(recorder) = &self.recorder {
            recorder.restart();
        }
    }

    fn watches(&self, key: Key) -> bool {
        self.recorder.is_some() || self.mutant.is_some_and(|mutant| mutant.key == key)
    }

    fn through(&self, key: Key, value: Value) -> Value {
        if let Some(recorder) = &self.recorder {
            recorder.record(key, self.state.get(), &value);
            return value;
        }
        match &self.mutant {
            Some(mutant) if mutant.key == key => {
                mutant.apply(&mut self.memory.borrow_mut(), self.state.get(), &value)
            }
            _ => value,
        }
    }

    /// One of several alternatives.
    pub fn pick<T: Copy + PartialEq>(
        &self,
        site: &'static str,
        part: &'static str,
        value: T,
        all: &[T],
    ) -> T {
        if !self.watches((site, part)) {
            return value;
        }
        let index = all.iter().position(|it| *it == value).expect("one of the alternatives");
        match self.through((site, part), Value::Pick { index, of: all.len() }) {
            Value::Pick { index, .. } => all[index],
            _ => value,
        }
    }

    /// A decision.
    pub fn flag(&self, site: &'static str, part: &'static str, value: bool) -> bool {
        self.pick(site, part, value, &[false, true])
    }

    pub fn state(&self, site: &'static str, part: &'static str, value: State) -> State {
        self.pick(site, part, value, State::ALL)
    }

    pub fn fault(&self, site: &'static str, value: FaultCode) -> FaultCode {
        self.pick(site, "code", value, FaultCode::ALL)
    }

    /// A check of a request: the outcome of its refusal, or none.
    pub fn refusal(&self, site: &'static str, part: &'static str, value: Option<Outcome>) -> Option<Outcome> {
        if !self.watches((site, part)) {
            return value;
        }
        let refusals = Outcome::ALL.iter().filter(|it| **it != Outcome::Accepted).map(|it| Some(*it));
        let all: Vec<_> = std::iter::once(None).chain(refusals).collect();
        self.pick(site, part, value, &all)
    }

    /// A number, with that which a mistaken drive would take instead.
    pub fn number_or(
        &self,
        site: &'static str,
        part: &'static str,
        (value, width): (f64, Width),
        other: Option<f64>,
    ) -> f64 {
        if !self.watches((site, part)) {
            return value;
        }
        match self.through((site, part), Value::Number { value, width, other }) {
            Value::Number { value, .. } => value,
            _ => value,
        }
    }

    /// A number of a calculation.
    pub fn real(&self, site: &'static str, part: &'static str, value: f64) -> f64 {
        self.number_or(site, part, (value, Width::Real), None)
    }

    pub fn whole(&self, site: &'static str, part: &'static str, value: i64) -> i64 {
        self.number_or(site, part, (value as f64, Width::Whole), None) as i64
    }

    pub fn text(&self, site: &'static str, part: &'static str, bytes: &mut [u8]) {
        if self.watches((site, part))
            && let Value::Text(text) = self.through((site, part), Value::Text(bytes.to_vec()))
        {
            bytes.copy_from_slice(&text);
        }
    }

    pub fn list(&self, site: &'static str, part: &'static str, list: Vec<f32>) -> Vec<f32> {
        if !self.watches((site, part)) {
            return list;
        }
        match self.through((site, part), Value::List(list)) {
            Value::List(list) => list,
            _ => vec![],
        }
    }
}
