//! Where an instance stands between instantiation and termination.

/// Phase of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    Instantiated = 0,
    Initialization = 1,
    Stepping = 2,
    Terminated = 3,
    Event = 4,
}

impl Phase {
    pub fn from_number(number: u64) -> Option<Phase> {
        use Phase::*;
        [Instantiated, Initialization, Stepping, Terminated, Event]
            .into_iter()
            .find(|p| *p as u64 == number)
    }

    pub fn name(self) -> &'static str {
        match self {
            Phase::Instantiated => "before initialization",
            Phase::Initialization => "in initialization mode",
            Phase::Stepping => "in step mode",
            Phase::Terminated => "after termination",
            Phase::Event => "in event mode",
        }
    }
}
