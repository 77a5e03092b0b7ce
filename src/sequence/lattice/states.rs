//! Takes states of one fixed size; gives each a number, once, and remembers from which state it was reached.
//!
//! States are compared whole, never by their hash alone. Not promised: room beyond the bytes that memory has; callers
//! bound the number of states.

/// Shift of one coordinate of one part from where it was at first, in lattice steps.
pub type Shift = i8;

/// States in the order in which they were found.
#[derive(Debug)]
pub struct States {
    width: usize,
    shifts: Vec<Shift>,
    from: Vec<u32>,
    /// Number of a state plus one, or 0; a power of two, at most half full.
    slots: Vec<u32>,
}

impl States {
    /// `width`: coordinates in a state.
    pub fn new(width: usize) -> States {
        States { width, shifts: Vec::new(), from: Vec::new(), slots: vec![0; 1 << 10] }
    }

    pub fn count(&self) -> usize {
        self.from.len()
    }

    pub fn get(&self, k: usize) -> &[Shift] {
        &self.shifts[k * self.width..(k + 1) * self.width]
    }

    /// The number of the state from which state `k` was reached; its own for the first.
    pub fn from(&self, k: usize) -> usize {
        self.from[k] as usize
    }

    /// Adds the state where it is new.
    pub fn add(&mut self, state: &[Shift], from: usize) {
        let mut at = hash(state) as usize & (self.slots.len() - 1);
        while self.slots[at] != 0 {
            if self.get(self.slots[at] as usize - 1) == state {
                return;
            }
            at = (at + 1) & (self.slots.len() - 1);
        }
        self.shifts.extend_from_slice(state);
        self.from.push(from as u32);
        self.slots[at] = self.from.len() as u32;
        if 2 * self.from.len() >= self.slots.len() {
            self.grow();
        }
    }

    fn grow(&mut self) {
        let mask = 2 * self.slots.len() - 1;
        let mut slots = vec![0; mask + 1];
        for k in 0..self.count() {
            let mut at = hash(self.get(k)) as usize & mask;
            while slots[at] != 0 {
                at = (at + 1) & mask;
            }
            slots[at] = k as u32 + 1;
        }
        self.slots = slots;
    }
}

/// Multiply and fold, eight coordinates at a time; the multiplier is 2^64 over the golden ratio, made odd.
fn hash(state: &[Shift]) -> u64 {
    const MULTIPLIER: u64 = 0x9e37_79b9_7f4a_7c15;
    let word = |chunk: &[Shift]| chunk.iter().fold(0u64, |w, &x| w << 8 | u64::from(x as u8));
    let mixed = |h: u64, w: u64| {
        let product = (h ^ w).wrapping_mul(MULTIPLIER);
        product ^ product >> 29
    };
    mixed(state.chunks(8).map(word).fold(state.len() as u64, mixed), MULTIPLIER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_is_kept_once_in_the_order_found() {
        let mut states = States::new(3);
        for k in 0..5000i32 {
            let state = [k % 50, k / 50 % 50, k / 2500].map(|x| x as Shift);
            states.add(&state, 0);
            states.add(&state, 1);
        }
        assert_eq!(states.count(), 5000);
        assert_eq!(states.get(4999), [49, 49, 1]);
        assert!((0..5000).all(|k| states.from(k) == 0));
    }
}
