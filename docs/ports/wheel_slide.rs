//! The built-in wheel-slide protection in Rust, for one file without crates: a port of wheel_slide.c.
//!
//!     rustc -O --crate-type cdylib wheel_slide.rs -o libwheel_slide.so
//!
//! The library has the three functions of wheel_slide.h. Names, units and comments of the C file hold here too. Rust does
//! not contract a * b + c, so the commands are those of the reference stops.

// Thresholds.
const LOWER_SLIP: f64 = 0.4;
const UPPER_SLIP: f64 = 0.8;
const EVIDENT_SLIP: f64 = 0.08;
const LEAST_EVIDENT_SLIP: f64 = 0.6;
const LEAD_TIME: f64 = 0.1;
const FIT_TIME: f64 = 0.06;
const CALM_TIME: f64 = 0.2;
const LARGEST_DECELERATION: f64 = 4.4;
const SYNCHRONISING_PERIOD: f64 = 8.0;
const WATCHDOG: f64 = 5.0;
const SLOWEST: f64 = 0.3;

// Numbers of slide_numbers.h.
const ROLLING: f64 = 0.3;
const SPEEDING: f64 = 0.6;
const GAIN: f64 = 0.25;
const GAIN_SHARE: f64 = 0.1;
const TOGETHER: f64 = 0.02;
const FREE: f64 = 1.5;
const QUIET: f64 = 2.0;
const SHORTEST_RELEASE: f64 = 0.25;
const LONGEST_RELEASE: f64 = 0.8;
const LOCKED_BELOW: f64 = 0.2;
const LOCKED_FROM: f64 = 0.5;
const SLIDING: f64 = 2.0;
const BEHIND: f64 = 0.3;
const FREELY_BRAKED: f64 = 0.3;
const SHORTEST_BETWEEN: f64 = 0.5;
const LEAST_DECELERATION: f64 = 0.1;
const SETTLING: f64 = 0.5;
const KEEPING: f64 = 1.0;
const SECOND_SYNCHRONISING: f64 = 1.5;
const FULL_BAND: f64 = 8.0;
const SLOW: f64 = 3.0;
const VENTED: f64 = 40.0;
const VENTED_MOST: f64 = 1.0;
const VENTED_FIRST: f64 = 0.3;
const FILLED: f64 = 13.0;
const LAG: f64 = 0.1;
const FILLING: f64 = 0.57;
const EMPTYING: f64 = 3.0;
const UNMOVED_VENTED: f64 = 2.0;
const UNMOVED_FILLED: f64 = 2.0;
const UNMOVED: f64 = 0.7;
const OF_VEHICLE: f64 = 0.1;
const OF_VEHICLE_MOST: f64 = 0.5;
const VENT_SEEN: f64 = 0.1;
const FASTER: f64 = 2.0;
const CREEP: f64 = 0.4;
const CREEPING: f64 = 0.35;
const BOUNDED: f64 = 1.5;
const POSTPONED: f64 = 5.0;
const NEAR: f64 = 0.8;
const NEAR_SHARE: f64 = 0.02;
const RELEASED: f64 = 1.5;
const STEADY: f64 = 0.4;
const STEADY_CHANGE: f64 = 0.4;
const PULSE: f64 = 0.04;
const NOISELESS: f64 = 0.045;
const NOISE_TIME: f64 = 2.0;
const NOISE_FIT: f64 = 0.1;
const NOISE_CALM: f64 = 0.15;
const NOISE_CHANGE: f64 = 8.0;
const NOISE_EVIDENT: f64 = 5.0;
const NOISE_MEASURED: f64 = 0.5;
const NOISE_BELOW: f64 = 1.5;
const COASTING: f64 = 0.3;
const SIZE_ABOVE: f64 = 3.0;
const SIZE_TIME: f64 = 0.3;
const SIZE_MOST: f64 = 0.05;
const JUMP: f64 = 4.0;
const JUMPING: f64 = 150.0;
const BETWEEN: f64 = 0.0045;
const STAYING: f64 = 0.3;
const STAYS: f64 = 0.5;
const STAYS_SLIDING: f64 = 0.15;
const BLIND: f64 = 1.0;
const BLIND_ABOVE: f64 = 3.0;
const AGREES: f64 = 0.05;
const AGREEING: f64 = 2.0;
const OF_NEIGHBOUR: f64 = 0.95;
const LEAST_SHARE: f64 = 0.65;
const MOST_SHARE: f64 = 1.0;
const STUCK_SHARE: f64 = 0.85;
const UNKNOWN_SHARE: f64 = 0.7;
const MEAN_TIME: f64 = 4.0;
const LOST_VENT: f64 = 0.4;
const STUCK_VENT: f64 = 0.05;
const UNSEEN_VENT: f64 = 0.8;
const REFILLED: f64 = 0.85;
const FIRST_SHARE: f64 = 0.8;
const FULL_TIME: f64 = 0.5;
const RECENT: usize = 5;
const KEPT: usize = 80;

const APPLY: i32 = 0;
const HOLD: i32 = 1;
const VENT: i32 = 2;

#[derive(Clone, Copy)]
struct Wheel {
    reading: f64,
    speed: f64,
    acceleration: f64,
    calm_speed: f64,
    calm_acceleration: f64,
    lowest: f64,
    noise: f64,
    size: f64,
    turns_since: f64,
    vents_since: f64,
    blocked_until: f64,
    kept: [f64; KEPT],
    kept_at: [f64; KEPT],
    recent_kept: [f64; RECENT],
    count: usize,
    newest: usize,
    recent: [f64; RECENT],
    changed_at: f64,
    others: f64,
    agrees_since: f64,
    readings: usize,
    venting: f64,
    filling: f64,
    pressure: f64,
    mean: f64,
    full_at: f64,
    share: f64,
    due: f64,
    vented_until: f64,
    unmoved_vented: f64,
    least_acceleration: f64,
    unmoved_filled: f64,
    unmoved_at: f64,
    unmoved_speed: f64,
    unmoved_acceleration: f64,
    steady_at: f64,
    steady_acceleration: f64,
    pulse_until: f64,
    turns: bool,
    vents: bool,
    locked: bool,
    refills: bool,
    speeds_up: bool,
    believed: bool,
    agrees: bool,
}

struct Vehicle {
    time: f64,
    reference: f64,
    deceleration: f64,
    before: f64,
    evident_at: f64,
    acted_at: f64,
    gained_at: f64,
    bounded_at: f64,
    synchronised_at: f64,
    synchronised_speed: f64,
    kept_at: f64,
    kept_speed: f64,
    synchronised: i32,
    released: Option<usize>,
    begun: bool,
    evident: bool,
    any_believed: bool,
}

struct Protection<'a> {
    own: &'a mut Vehicle,
    wheels: &'a mut [Wheel],
}

fn larger(one: f64, other: f64) -> f64 {
    if other > one {
        other
    } else {
        one
    }
}

fn smaller(one: f64, other: f64) -> f64 {
    if other < one {
        other
    } else {
        one
    }
}

fn largest_of(numbers: &[f64]) -> f64 {
    numbers[1..].iter().fold(numbers[0], |found, &one| larger(found, one))
}

fn possible(deceleration: f64) -> f64 {
    smaller(larger(deceleration, LEAST_DECELERATION), LARGEST_DECELERATION)
}

impl Wheel {
    fn is_judged(&self, time: f64) -> bool {
        self.turns && time - self.turns_since > SETTLING
    }

    fn agree(&mut self, time: f64, speed: f64, others: f64) {
        if speed == self.reading || (self.calm_speed - others).abs() > AGREES * others {
            self.agrees = false;
        } else if !self.agrees {
            self.agrees = true;
            self.agrees_since = time;
        } else if time - self.agrees_since > AGREEING {
            self.believed = true;
            self.readings = 0;
        }
    }

    fn jumps(&mut self, speed: f64, size: f64) -> bool {
        let whole = self.readings == RECENT;
        let before = if whole { largest_of(&self.recent) } else { 0.0 };
        if whole {
            self.recent.copy_within(1.., 0)
        } else {
            self.readings += 1
        }
        self.recent[self.readings - 1] = speed;
        whole && (largest_of(&self.recent) - before).abs() > JUMP + JUMPING * size
    }

    fn second(&mut self, speed: f64) -> f64 {
        self.recent_kept.copy_within(..RECENT - 1, 1);
        self.recent_kept[0] = speed;
        if self.recent_kept[RECENT - 1] <= 0.0 {
            return speed;
        }
        let mut sorted = self.recent_kept;
        sorted.sort_by(|one, other| other.total_cmp(one));
        sorted[1]
    }

    fn store(&mut self, time: f64, speed: f64) {
        if if self.count > 0 { time - self.kept_at[self.newest] < BETWEEN } else { speed <= 0.0 } {
            return;
        }
        self.newest = if self.count > 0 { (self.newest + 1) % KEPT } else { 0 };
        self.kept[self.newest] = self.second(speed);
        self.kept_at[self.newest] = time;
        if self.count < KEPT {
            self.count += 1
        }
    }

    /// End and slope of a line.
    fn fit(&self, time: f64, lasts: f64) -> (f64, f64) {
        let (mut n, mut t, mut tt, mut v, mut tv) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for k in 0..self.count {
            let place = (self.newest + KEPT - k) % KEPT;
            let at = self.kept_at[place] - time;
            if at < -lasts && k > 2 {
                break;
            }
            n += 1.0;
            t += at;
            tt += at * at;
            v += self.kept[place];
            tv += at * self.kept[place];
        }
        let spread = n * tt - t * t;
        let slope = if spread > 0.0 { (n * tv - t * v) / spread } else { 0.0 };
        ((v - slope * t) / n, slope)
    }

    fn noise(&self) -> f64 {
        larger(0.0, self.noise - NOISELESS)
    }

    fn filter(&mut self, time: f64, evident: bool, speed: f64, size: f64) {
        self.store(time, speed);
        if !self.turns {
            self.turns = speed > 0.0;
            self.turns_since = time;
            self.speed = speed;
            self.calm_speed = speed;
            self.lowest = speed;
        } else if size > 0.0 {
            if !evident && self.calm_acceleration.abs() < NOISE_BELOW {
                self.noise +=
                    ((self.kept[self.newest] - self.calm_speed).abs() - self.noise) * size / (size + NOISE_MEASURED);
            }
            let more = NOISE_TIME * self.noise();
            (self.speed, self.acceleration) = self.fit(time, FIT_TIME + smaller(NOISE_FIT, more));
            (self.calm_speed, self.calm_acceleration) = self.fit(time, CALM_TIME + smaller(NOISE_CALM, more));
        }
        self.reading = speed;
    }

    fn is_sized(&self, time: f64) -> bool {
        self.believed && self.is_judged(time) && self.calm_speed > SIZE_ABOVE
    }

    fn watch_filling(&mut self, time: f64) {
        self.unmoved_filled = 0.0;
        self.unmoved_at = time;
        self.unmoved_speed = self.calm_speed;
        self.unmoved_acceleration = self.calm_acceleration;
    }

    fn begin_steady(&mut self, time: f64) {
        self.steady_at = time;
        self.steady_acceleration = self.calm_acceleration;
    }

    fn is_pulsed(&mut self, time: f64) -> bool {
        if time < self.pulse_until {
            return true;
        }
        if self.steady_acceleration - self.calm_acceleration > STEADY_CHANGE {
            self.begin_steady(time)
        }
        if time - self.steady_at < STEADY {
            return false;
        }
        self.pulse_until = time + PULSE;
        true
    }

    fn follow(&mut self, time: f64, evident: bool, command: i32, size: f64) {
        let share = size / (size + LAG);
        let change = match command {
            APPLY => FILLING,
            VENT => -EMPTYING * self.pressure,
            _ => 0.0,
        };
        self.venting += share * (f64::from(command == VENT) - self.venting);
        self.filling += share * (f64::from(command == APPLY) - self.filling);
        self.pressure = larger(0.0, smaller(1.0, self.pressure + size * change));
        if evident {
            self.mean += size / (size + MEAN_TIME) * (self.pressure - self.mean)
        } else {
            self.mean = self.pressure
        }
        if self.pressure < 1.0 {
            self.full_at = time
        }
    }
}

impl Protection<'_> {
    fn is_seen(&self, number: usize) -> bool {
        self.wheels[number].believed || !self.own.any_believed
    }

    fn chosen(&self, fastest: bool) -> usize {
        let mut found: Option<usize> = None;
        for (i, one) in self.wheels.iter().enumerate() {
            if !self.is_seen(i) || (one.locked && found.is_some()) {
                continue;
            }
            let better = found.map_or(true, |best| {
                let best = &self.wheels[best];
                best.locked || if fastest { one.calm_speed > best.calm_speed } else { one.calm_speed < best.calm_speed }
            });
            if better {
                found = Some(i)
            }
        }
        found.unwrap_or(0)
    }

    fn is_blind(&self, others: f64) -> bool {
        let mut first: Option<f64> = None;
        for one in self.wheels.iter().filter(|one| one.turns) {
            if first.map_or(true, |since| one.turns_since < since) {
                first = Some(one.turns_since)
            }
        }
        first.is_some_and(|since| self.own.time - since > BLIND) && others > BLIND_ABOVE
    }

    fn neighbour_of(&self, number: usize) -> Option<usize> {
        let beside = number ^ 1;
        if beside < self.wheels.len() && self.wheels[beside].believed {
            return Some(beside);
        }
        self.wheels.iter().position(|one| one.believed)
    }

    fn lose(&mut self, number: usize, size: f64) {
        let (time, evident) = (self.own.time, self.own.evident);
        self.wheels[number].believed = false;
        self.wheels[number].agrees = false;
        let beside =
            self.neighbour_of(number).map(|beside| self.wheels[beside].mean).filter(|&mean| evident && mean > 0.0);
        let one = &mut self.wheels[number];
        one.vented_until = time + LOST_VENT;
        one.share = beside
            .map_or(UNKNOWN_SHARE, |mean| smaller(MOST_SHARE, larger(LEAST_SHARE, OF_NEIGHBOUR * one.mean / mean)));
        self.own.released = None;
        self.own.evident = evident && time - self.own.evident_at > (RECENT as f64 + 0.5) * size;
    }

    fn believe(&mut self, number: usize, speed: f64, size: f64) {
        let time = self.own.time;
        let mut fastest: Option<f64> = None;
        for (i, other) in self.wheels.iter().enumerate() {
            if i != number && other.believed && fastest.map_or(true, |most| other.calm_speed > most) {
                fastest = Some(other.calm_speed);
            }
        }
        let Some(others) = fastest else { return };
        if size == 0.0 {
            return;
        }
        if !self.wheels[number].turns {
            self.wheels[number].believed = self.wheels[number].believed && !self.is_blind(others);
            return;
        }
        let one = &mut self.wheels[number];
        if !one.believed {
            return one.agree(time, speed, others);
        }
        if speed != one.reading || speed == 0.0 || one.readings == 0 {
            one.changed_at = time;
            one.others = others;
        }
        let least = if self.own.evident { STAYS_SLIDING } else { STAYS };
        let stays = time - one.changed_at > STAYING && (others - one.others).abs() > least;
        if one.jumps(speed, size) || stays {
            self.lose(number, size)
        }
        if stays {
            self.wheels[number].vented_until = time + STUCK_VENT * others;
            self.wheels[number].share = STUCK_SHARE;
        }
    }

    fn measure_sizes(&mut self, size: f64) {
        let time = self.own.time;
        let (mut sum, mut count) = (0.0, 0);
        for one in self.wheels.iter().filter(|one| one.is_sized(time)) {
            if one.calm_acceleration.abs() > COASTING {
                return;
            }
            sum += one.calm_speed;
            count += 1;
        }
        if count < 2 {
            return;
        }
        for one in self.wheels.iter_mut().filter(|one| one.is_sized(time)) {
            let change = one.size * (sum / f64::from(count) / one.calm_speed - 1.0) * size / (size + SIZE_TIME);
            one.size = larger(1.0 - SIZE_MOST, smaller(1.0 + SIZE_MOST, one.size + change));
        }
    }

    fn measure(&mut self, speed: f64) {
        let own = &mut *self.own;
        let elapsed = larger(own.time - own.synchronised_at, SHORTEST_BETWEEN);
        own.before = own.deceleration;
        own.deceleration = possible((own.synchronised_speed - speed) / elapsed);
    }

    fn keep(&mut self, speed: f64) {
        let own = &mut *self.own;
        let known = own.kept_speed > 0.0;
        if known && own.time - own.kept_at < KEEPING {
            return;
        }
        own.synchronised_at = if known { own.kept_at } else { own.time };
        own.synchronised_speed = if known { own.kept_speed } else { speed };
        own.kept_at = own.time;
        own.kept_speed = speed;
    }

    fn roll(&mut self, size: f64, fastest: usize) {
        self.own.reference = larger(self.wheels[fastest].calm_speed, self.own.reference - LARGEST_DECELERATION * size);
        self.keep(self.own.reference);
        let reference = self.own.reference;
        let (mut any, mut most, mut least, mut unsure) = (false, 0.0, 0.0, 0.0);
        for (i, one) in self.wheels.iter().enumerate() {
            unsure = larger(unsure, NOISE_EVIDENT * one.noise());
            if !self.is_seen(i) || !one.is_judged(self.own.time) {
                continue;
            }
            let behind = reference - one.calm_speed;
            most = if any { larger(most, behind) } else { behind };
            least = if any { smaller(least, behind) } else { behind };
            any = true;
        }
        let apart = larger(EVIDENT_SLIP * reference, LEAST_EVIDENT_SLIP);
        let together = larger(TOGETHER * reference, LEAST_EVIDENT_SLIP);
        if !any || !(most > apart + unsure || least > together + unsure) {
            return;
        }
        self.own.evident = true;
        self.own.evident_at = self.own.time;
        self.own.gained_at = self.own.time;
        self.own.synchronised = 0;
        self.measure(reference);
    }

    fn known_deceleration(&self, fastest: usize) -> f64 {
        if self.own.time - self.own.acted_at < FREELY_BRAKED {
            return self.own.deceleration;
        }
        larger(self.own.deceleration, possible(-self.wheels[fastest].calm_acceleration))
    }

    fn find_gain(&mut self, number: usize) {
        let (time, one) = (self.own.time, &mut self.wheels[number]);
        one.lowest = smaller(one.lowest, one.calm_speed);
        if one.calm_speed > LOCKED_BELOW * self.own.reference {
            one.locked = false;
        } else if one.vents && !one.speeds_up && time - one.vents_since > LOCKED_FROM {
            one.locked = true;
        }
        let gain = smaller(GAIN, GAIN_SHARE * larger(one.calm_speed, SLOW));
        if !(one.calm_acceleration > SPEEDING && one.calm_speed - one.lowest > gain) {
            return;
        }
        one.speeds_up = true;
        self.own.gained_at = time;
    }

    fn gained_by_venting(&self) -> f64 {
        let own = &self.own;
        let known = if own.synchronised < 2 { VENTED_FIRST } else { smaller(own.deceleration, own.before) };
        VENTED * smaller(known, VENTED_MOST)
    }

    fn test_response(&mut self, number: usize, size: f64) {
        let by_venting = self.gained_by_venting();
        let (time, deceleration, one) = (self.own.time, self.own.deceleration, &mut self.wheels[number]);
        let (acceleration, unsure) = (one.calm_acceleration, NOISE_CHANGE * one.noise());
        let (filled, vented) = (FILLED * one.filling, by_venting * one.venting);
        one.least_acceleration = smaller(one.least_acceleration, acceleration);
        let gained = acceleration - one.least_acceleration;
        let of_vehicle = smaller(OF_VEHICLE_MOST, OF_VEHICLE * one.unmoved_vented);
        if acceleration > ROLLING + unsure
            || acceleration < -deceleration - FASTER
            || gained > UNMOVED + unsure + of_vehicle
        {
            one.unmoved_vented = 0.0;
            one.least_acceleration = acceleration;
        } else {
            one.unmoved_vented = larger(0.0, one.unmoved_vented + size * (vented - filled));
            if one.unmoved_vented == 0.0 {
                one.least_acceleration = acceleration
            }
        }
        let own = 0.5 * smaller(OF_VEHICLE_MOST, OF_VEHICLE * one.unmoved_filled);
        let moved = (acceleration - one.unmoved_acceleration + own).abs() > UNMOVED + unsure + own;
        if moved || one.venting > VENT_SEEN {
            one.watch_filling(time);
        } else {
            one.unmoved_filled = larger(0.0, one.unmoved_filled + size * (filled - vented));
        }
    }

    fn is_near(&self, number: usize) -> bool {
        let reference = self.own.reference;
        self.own.synchronised != 0 && self.wheels[number].calm_speed > reference - NEAR - NEAR_SHARE * reference
    }

    fn has_caught_up(&self, number: usize, fastest: usize) -> bool {
        let (one, most) = (&self.wheels[number], self.wheels[fastest].calm_speed);
        let vented = if one.vents { self.own.time - one.vents_since } else { 0.0 };
        let unsized_by = if vented > LONGEST_RELEASE { SIZE_MOST * most } else { 0.0 };
        if one.calm_speed < most - BEHIND - unsized_by {
            return false;
        }
        if self.is_near(number) {
            return one.unmoved_vented > UNMOVED_VENTED;
        }
        let longest = if one.speeds_up { SHORTEST_RELEASE } else { LONGEST_RELEASE };
        let rolls = one.calm_acceleration < ROLLING && one.calm_acceleration > -SLIDING;
        one.vents && !one.locked && rolls && vented > longest
    }

    fn synchronise(&mut self, speed: f64) {
        let time = self.own.time;
        let later = self.own.synchronised == 0 || time - self.own.synchronised_at > SHORTEST_BETWEEN;
        if later {
            self.measure(speed);
            self.own.synchronised_at = time;
            self.own.kept_at = time;
            self.own.synchronised_speed = speed;
            self.own.kept_speed = speed;
            self.own.synchronised += 1;
        }
        self.own.reference = speed;
        self.own.released = None;
        for one in self.wheels.iter_mut() {
            if later {
                one.lowest = one.calm_speed
            }
            one.unmoved_vented = 0.0;
            one.watch_filling(time);
        }
    }

    fn bound(&mut self, number: usize) {
        let (own, one) = (&mut *self.own, &self.wheels[number]);
        let (lost, lasts) = (one.unmoved_speed - one.calm_speed, own.time - one.unmoved_at);
        let (least, most) = ((lost - CREEP) / lasts - CREEPING, (lost + CREEP) / lasts);
        own.deceleration = possible(smaller(larger(own.deceleration, least), most));
        own.reference = smaller(own.reference, one.calm_speed + CREEP);
        if lasts > BOUNDED {
            own.bounded_at = own.time
        }
    }

    fn slide(&mut self, size: f64, fastest: usize) {
        let falls = self.known_deceleration(fastest);
        let mut shows: Option<usize> = None;
        self.own.reference = larger(self.wheels[fastest].calm_speed, self.own.reference - falls * size);
        for i in 0..self.wheels.len() {
            if !self.is_seen(i) {
                continue;
            }
            self.find_gain(i);
            self.test_response(i, size);
            let more = shows.map_or(true, |best| self.wheels[i].calm_speed > self.wheels[best].calm_speed);
            if self.has_caught_up(i, fastest) && more {
                shows = Some(i)
            }
        }
        if let Some(best) = shows {
            self.synchronise(larger(self.wheels[best].calm_speed, self.wheels[fastest].calm_speed));
        } else {
            for i in 0..self.wheels.len() {
                if self.is_seen(i) && self.is_near(i) && self.wheels[i].unmoved_filled > UNMOVED_FILLED {
                    self.bound(i)
                }
            }
        }
        let quiet = self.own.time - self.own.acted_at > FREE && self.own.time - self.own.gained_at > QUIET;
        if self.own.synchronised > 1 && quiet {
            self.own.evident = false
        }
        if self.own.reference < SLOWEST {
            self.own.evident = false;
            self.own.released = None;
        }
    }

    fn is_released(&mut self, number: usize) -> bool {
        let due = match self.own.synchronised {
            0 => 0.0,
            1 => SECOND_SYNCHRONISING,
            _ => SYNCHRONISING_PERIOD,
        };
        if self.own.released.is_some_and(|one| self.wheels[one].locked) {
            self.own.released = None
        }
        let most = self.own.synchronised_at + POSTPONED;
        let since = self.own.time - larger(self.own.synchronised_at, smaller(self.own.bounded_at, most));
        if self.own.released.is_none() && since > due {
            self.own.released = Some(self.chosen(self.own.synchronised > 0));
        }
        self.own.released == Some(number)
    }

    fn coming(&self, number: usize) -> f64 {
        let one = &self.wheels[number];
        one.acceleration + LAG * (self.gained_by_venting() * one.venting - FILLED * one.filling)
    }

    fn by_release(&self, number: usize) -> i32 {
        if self.wheels[number].acceleration > ROLLING && self.coming(number) > RELEASED {
            HOLD
        } else {
            VENT
        }
    }

    fn by_slip(&mut self, number: usize) -> i32 {
        let rate = -self.own.deceleration - self.coming(number);
        let one = &mut self.wheels[number];
        let slip = self.own.reference - one.speed + LEAD_TIME * rate;
        let share = smaller(1.0, larger(self.own.reference, SLOW) / FULL_BAND);
        if slip > UPPER_SLIP * share {
            return VENT;
        }
        if slip < LOWER_SLIP * share || one.unmoved_filled > UNMOVED_FILLED {
            return APPLY;
        }
        if one.is_pulsed(self.own.time) {
            APPLY
        } else {
            HOLD
        }
    }

    fn command_of(&mut self, number: usize) -> i32 {
        let time = self.own.time;
        let one = &mut self.wheels[number];
        let judged = self.own.evident && one.is_judged(time);
        if !judged || self.own.reference < SLOWEST || time < one.blocked_until {
            one.vents = false;
            return APPLY;
        }
        let released = self.is_released(number);
        let command = if released { self.by_release(number) } else { self.by_slip(number) };
        if command != APPLY {
            self.own.acted_at = time
        }
        let one = &mut self.wheels[number];
        if command != HOLD {
            one.begin_steady(time)
        }
        if command != VENT && !(released && one.vents) {
            one.vents = false;
        } else if !one.vents {
            one.vents = true;
            one.vents_since = time;
            one.speeds_up = false;
            one.lowest = one.calm_speed;
        } else if time - one.vents_since > WATCHDOG {
            one.blocked_until = time + WATCHDOG;
            return APPLY;
        }
        command
    }

    fn unseen_command(&mut self, number: usize, valve: &[i32]) -> i32 {
        let time = self.own.time;
        let Some(neighbour) = self.neighbour_of(number) else { return APPLY };
        let (pressure, full_at) = (self.wheels[neighbour].pressure, self.wheels[neighbour].full_at);
        let one = &mut self.wheels[number];
        if !self.own.evident {
            one.vented_until = time + UNSEEN_VENT;
            one.due = 0.0;
            let behind = pressure < 1.0 || time - full_at < FULL_TIME;
            return if behind && one.pressure > FIRST_SHARE * pressure { HOLD } else { APPLY };
        }
        let vents = time < one.vented_until;
        one.refills = vents || (one.refills && one.pressure < REFILLED * one.share * pressure);
        if vents {
            return VENT;
        }
        if one.refills {
            return APPLY;
        }
        if valve[neighbour] != APPLY {
            return valve[neighbour];
        }
        one.due += one.share;
        if one.due < 1.0 {
            return HOLD;
        }
        one.due -= 1.0;
        APPLY
    }

    fn take(&mut self, speeds: &[f64], size: f64) {
        for (i, &reading) in speeds.iter().enumerate() {
            if !reading.is_finite() {
                if self.wheels[i].believed {
                    self.lose(i, size)
                }
                self.wheels[i].agrees = false;
                continue;
            }
            let speed = self.wheels[i].size * reading;
            self.believe(i, speed, size);
            let speed = self.wheels[i].size * reading;
            self.wheels[i].filter(self.own.time, self.own.evident, speed, size);
        }
        if !self.own.evident {
            self.measure_sizes(size)
        }
        let coasts = self.wheels.iter().all(|one| !(one.believed && one.calm_acceleration.abs() > COASTING));
        if !self.own.evident && coasts {
            self.wheels.iter_mut().for_each(|one| one.pressure = 0.0)
        }
        self.own.any_believed = self.wheels.iter().any(|one| one.believed);
    }

    fn step(&mut self, time: f64, speeds: &[f64], valve: &mut [i32]) {
        let size = if self.own.begun { time - self.own.time } else { 0.0 };
        self.own.begun = true;
        self.own.time = time;
        self.take(speeds, size);
        let fastest = self.chosen(true);
        if self.own.evident {
            self.slide(size, fastest)
        } else {
            self.roll(size, fastest)
        }
        for i in 0..valve.len() {
            if self.wheels[i].believed {
                valve[i] = self.command_of(i)
            }
        }
        for i in 0..valve.len() {
            if !self.wheels[i].believed {
                valve[i] = self.unseen_command(i, valve)
            }
            self.wheels[i].follow(self.own.time, self.own.evident, valve[i], size);
        }
    }
}

/// Memory of a controller: this head, then the wheelsets.
#[repr(C)]
struct Head {
    own: Vehicle,
    wheelsets: usize,
}

#[no_mangle]
pub extern "C" fn wheel_slide_size(wheelsets: i32) -> usize {
    std::mem::size_of::<Head>() + wheelsets.max(0) as usize * std::mem::size_of::<Wheel>()
}

/// # Safety
/// `memory` has the bytes of wheel_slide_size, all of them 0, and is aligned for any type.
#[no_mangle]
pub unsafe extern "C" fn wheel_slide_start(memory: *mut std::ffi::c_void, wheelsets: i32, _period: f64) {
    let head = memory.cast::<Head>();
    (*head).wheelsets = wheelsets as usize;
    (*head).own.evident_at = f64::NEG_INFINITY;
    (*head).own.acted_at = f64::NEG_INFINITY;
    (*head).own.released = None;
    let wheels = std::slice::from_raw_parts_mut(head.add(1).cast::<Wheel>(), wheelsets as usize);
    for one in wheels {
        one.believed = true;
        one.size = 1.0;
        one.share = UNKNOWN_SHARE;
        one.blocked_until = f64::NEG_INFINITY;
        one.changed_at = f64::NEG_INFINITY;
    }
}

/// # Safety
/// `memory` is that of a started controller; `wheel_speed` and `valve` have a number for each wheelset.
#[no_mangle]
pub unsafe extern "C" fn wheel_slide_step(
    memory: *mut std::ffi::c_void,
    time: f64,
    wheel_speed: *const f64,
    valve: *mut i32,
) {
    let head = memory.cast::<Head>();
    let count = (*head).wheelsets;
    let wheels = std::slice::from_raw_parts_mut(head.add(1).cast::<Wheel>(), count);
    let speeds = std::slice::from_raw_parts(wheel_speed, count);
    let valve = std::slice::from_raw_parts_mut(valve, count);
    Protection { own: &mut (*head).own, wheels }.step(time, speeds, valve);
}
