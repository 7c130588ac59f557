//! The messages between robots, as the slot loop sees them: what was sent goes to the channel at a slot's end, and what becomes
//! of it to those who are to know.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use parking_lot::MutexGuard;
use sim_core::RobotId;
use sim_core::radio::{Channel, Delivery, Sending};
use sim_core::time::Time;

use crate::robios::radio;
use crate::robios::robot::Robot;

/// What is under way.
#[derive(Default)]
pub struct Traffic {
    /// What was sent in the present slot.
    sendings: Vec<Sending>,
    /// What the channel has decided at the present slot's end.
    decided: Vec<Delivery>,
    /// What has left the buffers of its senders by then.
    left: Vec<(RobotId, u64)>,
    /// When something becomes visible, and to whom.
    visible: BinaryHeap<Reverse<(Time, RobotId)>>,
}

impl Traffic {
    /// Takes what `robot` has sent in the slot that ends, and tells the channel whether its radio is on.
    pub fn collect(&mut self, robot: &mut Robot, channel: &mut Channel) {
        let Some(news) = robot.devices.radio.take_news() else { return };
        if let Some(change) = news.change {
            channel.change(change);
        }
        self.sendings.extend(news.sendings);
    }

    /// Lets the channel decide what it can by `slot_end`; whom that concerns, and to whom something became visible in the slot.
    pub fn exchange(&mut self, slot_end: Time, channel: &mut Channel, concerned: &mut Vec<RobotId>) {
        if !self.sendings.is_empty() || channel.due() <= slot_end {
            self.decided = channel.exchange(slot_end, std::mem::take(&mut self.sendings));
            // Those of one robot that become visible together stand together.
            concerned.extend(self.decided.chunk_by(|one, other| one.to == other.to).map(|chunk| chunk[0].to));
            self.left = channel.take_left();
            concerned.extend(self.left.iter().map(|(robot, _)| *robot));
        }
        while let Some(Reverse((visible, robot))) = self.visible.peek()
            && *visible < slot_end
        {
            concerned.push(*robot);
            self.visible.pop();
        }
    }

    /// Gives each robot what concerns it and settles the slot that ends; `robots` are those that [`Traffic::exchange`] named, and
    /// others, in the order of their ids.
    pub fn deliver(&mut self, slot_end: Time, robots: &mut [MutexGuard<'_, Robot>]) {
        for (robot, sequence) in self.left.drain(..) {
            if let Ok(place) = robots.binary_search_by_key(&robot, |robot| robot.id) {
                robots[place].devices.radio.has_left(sequence);
            }
        }
        let mut last = None;
        for delivery in self.decided.drain(..) {
            let Delivery { to, visible, .. } = delivery;
            if let Ok(place) = robots.binary_search_by_key(&to, |robot| robot.id) {
                radio::deliver(&mut robots[place], delivery);
                if last.replace((visible, to)) != Some((visible, to)) {
                    self.visible.push(Reverse((visible, to)));
                }
            }
        }
        for robot in robots {
            radio::settle(robot, slot_end - Time(1));
        }
    }

    /// When a slot is to be run for messages though nobody is due; [`Time::NEVER`] if none is under way.
    pub fn due(&self, channel: &Channel) -> Time {
        self.visible.peek().map_or(Time::NEVER, |Reverse((visible, _))| *visible).min(channel.due())
    }
}
