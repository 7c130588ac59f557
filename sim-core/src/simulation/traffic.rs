//! The messages between robots at a slot's end: what was sent goes to the channel, and what becomes of it to those whom it concerns.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Robot;
use crate::RobotId;
use crate::radio::{Channel, Delivery, Sending};
use crate::time::Time;

/// What is under way.
#[derive(Clone, Debug, Default)]
pub(super) struct Traffic {
    /// What was sent in the present slot.
    sendings: Vec<Sending>,
    /// What the channel has decided at the present slot's end.
    decided: Vec<Delivery>,
    /// What has left the buffers of its senders by then.
    left: Vec<(RobotId, u64)>,
    /// When something becomes visible, and to whom.
    visible: BinaryHeap<Reverse<(Time, RobotId)>>,
    /// When the run ended.
    end: Time,
}

impl Traffic {
    /// Takes what `robot` has sent in the slot that ends, and tells the channel whether its radio is on.
    pub fn collect(&mut self, robot: &mut Robot, channel: &mut Channel) {
        let Some(station) = &mut robot.station else { return };
        if let Some(change) = station.take_change() {
            channel.change(change);
        }
        self.sendings.append(&mut station.take_sent());
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
    /// others, in the order of their ids. To whom something comes, and when it is visible.
    pub fn deliver(&mut self, slot_end: Time, robots: &mut [&mut Robot]) -> Vec<(RobotId, Time)> {
        for (robot, sequence) in self.left.drain(..) {
            if let Ok(place) = robots.binary_search_by_key(&robot, |robot| robot.id)
                && let Some(station) = &mut robots[place].station
            {
                station.has_left(sequence);
            }
        }
        let mut heard = Vec::new();
        let mut last = None;
        for delivery in self.decided.drain(..) {
            let Delivery { to, visible, .. } = delivery;
            if let Ok(place) = robots.binary_search_by_key(&to, |robot| robot.id) {
                robots[place].deliver(delivery);
                heard.push((to, visible));
                if last.replace((visible, to)) != Some((visible, to)) {
                    self.visible.push(Reverse((visible, to)));
                }
            }
        }
        for robot in robots {
            robot.settle_radio(slot_end - Time(1));
        }
        heard
    }

    /// The run ends at `end`: what becomes of the messages about which `channel` has not decided.
    pub fn finish(&mut self, end: Time, channel: &mut Channel) {
        self.decided = channel.finish(end);
        // The first robot's come last, where they are taken from.
        self.decided.reverse();
        self.end = end;
    }

    /// Records what becomes of the messages on their way to `robot`, when the run has ended.
    pub fn finish_robot(&mut self, robot: &mut Robot) {
        while let Some(fate) = self.decided.pop_if(|fate| fate.to == robot.id) {
            robot.deliver(fate);
        }
        robot.finish_radio(self.end);
    }

    /// When a slot is to be run for messages though nobody is due; [`Time::NEVER`] if none is under way.
    pub fn due(&self, channel: &Channel) -> Time {
        self.visible.peek().map_or(Time::NEVER, |Reverse((visible, _))| *visible).min(channel.due())
    }
}
