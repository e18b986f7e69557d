//! The values of the drive's parameters, and the requests for them: describe, get and set.
//!
//! The values are 32-bit words in the order of the set's table; the index on the wire is the index in both. A drive with
//! pins has the parameters of bench mode after them.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterFlags, ParameterValue, State};
use lashloop_protocol::message::{ChoiceDescription, ParameterDescription, ParameterReport, SetParameter};
use lashloop_protocol::text::Text;

use super::lists;
use super::pin_parameters::{PinParameters, SampleSource};
use super::refusal::Refusal;
use crate::law::{DriveParameters, LawSet, Parameter, ParameterError, ParameterGroup, Words, table};
use crate::store::{Store, entry};

/// Indices of the drive's own parameters: every table begins with `controller`, then has these.
static OF_DRIVE: [u8; DriveParameters::TABLE.len()] = {
    let mut indices = [0; DriveParameters::TABLE.len()];
    let mut at = 0;
    while at < indices.len() {
        indices[at] = at as u8 + 1;
        at += 1;
    }
    indices
};

/// Indices of the parameters of bench mode among their own words.
static OF_PINS: [u8; PIN_COUNT] = {
    let mut indices = [0; PIN_COUNT];
    let mut at = 0;
    while at < PIN_COUNT {
        indices[at] = at as u8;
        at += 1;
    }
    indices
};

const PIN_COUNT: usize = PinParameters::TABLE.len();
const PIN_DEFAULTS: [u32; PIN_COUNT] = table::defaults(PinParameters::TABLE);

/// The values in force.
pub(super) struct Parameters<L: LawSet> {
    words: L::Words,
    /// Words of the parameters of bench mode; `None` for a drive without pins.
    pins: Option<[u32; PIN_COUNT]>,
}

impl<L: LawSet> Parameters<L> {
    /// Two parameters of one name, or more than an index can number, don't compile.
    const CHECKED: () = {
        table::check_appended(L::PARAMETERS, PinParameters::TABLE);
        entry::check_keys(L::PARAMETERS, PinParameters::TABLE);
    };

    /// The defaults of the firmware. A drive with pins has the parameters of bench mode after all others.
    pub(super) fn new(has_pins: bool) -> Self {
        let () = Self::CHECKED;
        Self { words: L::DEFAULTS, pins: has_pins.then_some(PIN_DEFAULTS) }
    }

    /// Sets every parameter to its default.
    pub(super) fn recall(&mut self, store: Option<&Store>) {
        *self = Self::new(self.pins.is_some());
        // What a store has takes 0.2 ms, and a run that a `Reset` ends has its bridge on until then.
        let Some(store) = store.filter(|store| store.holds_values()) else { return };
        for index in 0..self.count() {
            if let Some((parameter, _)) = self.entry(index) {
                self.write(index, default_word(index, &parameter, Some(store)));
            }
        }
    }

    /// What a record has at this place: the parameter with this index.
    pub(super) fn entry_to_store(&self, index: usize) -> [u32; 2] {
        match self.entry(index as u8) {
            Some((parameter, word)) => [entry::key(&parameter), entry::stored(parameter.range, word)],
            None => [u32::MAX; 2],
        }
    }

    pub(super) fn count(&self) -> u8 {
        (L::PARAMETERS.len() + self.pins.map_or(0, |words| words.len())) as u8
    }

    pub(super) fn words(&self) -> &L::Words {
        &self.words
    }

    /// Index of the law in force: the value of the first parameter.
    pub(super) fn law(&self) -> u32 {
        self.words.as_ref().first().copied().unwrap_or_default()
    }

    /// The drive's own parameters.
    pub(super) fn drive(&self) -> DriveParameters {
        DriveParameters::read(&mut Words::new(self.words.as_ref(), &OF_DRIVE))
    }

    /// The parameters of bench mode of a drive with pins.
    pub(super) fn pins(&self) -> Option<PinParameters> {
        Some(<PinParameters as ParameterGroup>::read(&mut Words::new(self.pins.as_ref()?, &OF_PINS)))
    }

    /// The parameters of bench mode, if that mode is selected.
    pub(super) fn bench_mode(&self) -> Option<PinParameters> {
        self.pins().filter(|parameters| parameters.sample_source == SampleSource::Pins)
    }

    /// The refusal of parameters that don't go together. For a name that the drive doesn't have it is that of `controller`.
    pub(super) fn inconsistent(error: &ParameterError) -> Refusal {
        let mut table = L::PARAMETERS.iter().chain(PinParameters::TABLE);
        let index = table.position(|parameter| parameter.name == error.name);
        Refusal { outcome: Outcome::Inconsistent, detail: index.unwrap_or(0) as u32 }
    }

    pub(super) fn get(&self, index: u8, state: State) -> ParameterReport {
        self.report(index, Ok(()), state)
    }

    /// Sets a value. The report carries the value in force, whether it was set or not. An armed or running drive has an `update`
    /// that hands the words to the law, and fails if they don't go together.
    pub(super) fn set(
        &mut self,
        request: &SetParameter,
        state: State,
        update: Option<impl FnOnce(&L::Words) -> Result<(), ParameterError>>,
    ) -> ParameterReport {
        let result = self.put(request, state, update);
        self.report(request.index, result, state)
    }

    /// The description of a parameter.
    pub(super) fn describe(&self, index: u8, state: State, store: Option<&Store>) -> DriveMessage {
        match self.entry(index) {
            Some((parameter, _)) => description(index, &parameter, default_word(index, &parameter, store)),
            None => self.report(index, Ok(()), state).into(),
        }
    }

    /// The name of a value; `None` if no parameter and no list of the drive has this index, or none of its values this number.
    pub(super) fn describe_choice(&self, parameter: u8, choice: u8) -> Option<DriveMessage> {
        let of_parameter = || self.entry(parameter)?.0.range.choices()?.get(usize::from(choice)).copied();
        let name = Text::new(lists::name(parameter, choice).or_else(of_parameter)?);
        Some(ChoiceDescription { parameter, choice, name }.into())
    }

    /// The parameter with this index and its word.
    fn entry(&self, index: u8) -> Option<(Parameter, u32)> {
        let at = usize::from(index);
        if let (Some(parameter), Some(word)) = (L::PARAMETERS.get(at), self.words.as_ref().get(at)) {
            return Some((*parameter, *word));
        }
        let at = at.checked_sub(L::PARAMETERS.len())?;
        let (parameter, word) = (PinParameters::TABLE.get(at)?, self.pins?.get(at).copied()?);
        // As the parameters of the drive itself, `controller` for one, these are of all laws.
        let laws = L::PARAMETERS.first().map_or(0, |controller| controller.laws);
        Some((Parameter { laws, ..*parameter }, word))
    }

    fn put(
        &mut self,
        request: &SetParameter,
        state: State,
        update: Option<impl FnOnce(&L::Words) -> Result<(), ParameterError>>,
    ) -> Result<(), Refusal> {
        let (parameter, before) = self.entry(request.index).ok_or(Outcome::UnknownIndex)?;
        let may_be_set = state == State::Idle || parameter.live && update.is_some();
        if !may_be_set {
            return Err(Outcome::WrongState.into());
        }
        self.write(request.index, parameter.range.word(request.value)?);
        if let Some(update) = update
            && let Err(error) = update(&self.words)
        {
            self.write(request.index, before);
            return Err(Self::inconsistent(&error));
        }
        Ok(())
    }

    fn write(&mut self, index: u8, word: u32) {
        let mut words = self.words.as_mut().iter_mut().chain(self.pins.iter_mut().flatten());
        if let Some(place) = words.nth(index.into()) {
            *place = word;
        }
    }

    /// The value in force; zero and `UnknownIndex` if no parameter has this index.
    fn report(&self, index: u8, result: Result<(), Refusal>, state: State) -> ParameterReport {
        let (value, result) = match self.entry(index) {
            Some((parameter, word)) => (parameter.range.value(word), result),
            None => (ParameterValue::U32(0), Err(Outcome::UnknownIndex.into())),
        };
        let Refusal { outcome, detail } = Refusal::of(result);
        ParameterReport { index, outcome, value, state, detail, device_time_us: None }
    }
}

/// The stored word, or the one of the firmware: if none is stored, or one that the parameter can't have.
fn default_word(index: u8, parameter: &Parameter, store: Option<&Store>) -> u32 {
    let stored = store.and_then(|store| store.word(entry::key(parameter), index.into()));
    let recalled = stored.and_then(|stored| entry::recalled(parameter.range, stored));
    recalled.unwrap_or(parameter.range.default_word())
}

fn description(index: u8, parameter: &Parameter, default: u32) -> DriveMessage {
    let range = parameter.range;
    let mut flags = ParameterFlags::empty();
    flags.set(ParameterFlags::CHOICES, range.choices().is_some());
    flags.set(ParameterFlags::LIVE, parameter.live);
    ParameterDescription {
        index,
        flags,
        laws: parameter.laws,
        default: range.value(default),
        min: range.min(),
        max: range.max(),
        name: Text::new(parameter.name),
        unit: Text::new(parameter.unit),
    }
    .into()
}
