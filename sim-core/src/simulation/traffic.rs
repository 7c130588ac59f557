//! Messages at a slot's end: passes sent messages to the channel and outcomes to the affected robots.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Robot;
use crate::RobotId;
use crate::radio::{Channel, Delivery, OutgoingMessage};
use crate::time::Time;

/// Messages between stations and channel.
#[derive(Clone, Debug, Default)]
pub(super) struct Traffic {
    /// Messages queued in the present slot.
    messages: Vec<OutgoingMessage>,
    /// Outcomes that the channel has decided at the present slot's end.
    decided: Vec<Delivery>,
    /// Messages that have left the buffers of their senders by the slot's end: (sender, number).
    departed: Vec<(RobotId, u64)>,
    /// Times when messages become visible, with their receivers.
    visible: BinaryHeap<Reverse<(Time, RobotId)>>,
    /// End of the run.
    end: Time,
}

impl Traffic {
    /// Takes the messages that `robot` has sent in the slot that ends, and reports switching of its radio to the channel.
    pub fn collect(&mut self, robot: &mut Robot, channel: &mut Channel) {
        let Some(station) = &mut robot.station else { return };
        if let Some(change) = station.take_change() {
            channel.report_change(change);
        }
        self.messages.append(&mut station.take_outgoing());
    }

    /// Makes the channel decide the messages up to `slot_end`. Adds to `concerned` the robots that the outcomes affect
    /// and the robots for which a message has become visible.
    pub fn exchange(&mut self, slot_end: Time, channel: &mut Channel, concerned: &mut Vec<RobotId>) {
        if !self.messages.is_empty() || channel.due() <= slot_end {
            self.decided = channel.exchange(slot_end, std::mem::take(&mut self.messages));
            // Deliveries to one robot that become visible together are adjacent.
            concerned.extend(self.decided.chunk_by(|one, other| one.to == other.to).map(|chunk| chunk[0].to));
            self.departed = channel.take_transmitted();
            concerned.extend(self.departed.iter().map(|(robot, _)| *robot));
        }
        while let Some(Reverse((visible, robot))) = self.visible.peek()
            && *visible < slot_end
        {
            concerned.push(*robot);
            self.visible.pop();
        }
    }

    /// Delivers the outcomes in the slot that ends. `robots` must include the robots that [`Traffic::exchange`] named,
    /// in the order of their ids. Returns the receivers of messages, each with the time when the message becomes
    /// visible.
    pub fn deliver(&mut self, robots: &mut [&mut Robot]) -> Vec<(RobotId, Time)> {
        for (robot, sequence) in self.departed.drain(..) {
            if let Ok(index) = robots.binary_search_by_key(&robot, |robot| robot.id)
                && let Some(station) = &mut robots[index].station
            {
                station.release(sequence);
            }
        }
        let mut arrivals = Vec::new();
        let mut last = None;
        for delivery in self.decided.drain(..) {
            let Delivery { to, visible, .. } = delivery;
            if let Ok(index) = robots.binary_search_by_key(&to, |robot| robot.id) {
                robots[index].deliver(delivery);
                arrivals.push((to, visible));
                if last.replace((visible, to)) != Some((visible, to)) {
                    self.visible.push(Reverse((visible, to)));
                }
            }
        }
        arrivals
    }

    /// Ends the run at `end`: takes the messages that `channel` has not decided as losses.
    pub fn finish(&mut self, end: Time, channel: &mut Channel) {
        self.decided = channel.finish(end);
        // `finish_robot` pops from the end, beginning with the first robot.
        self.decided.reverse();
        self.end = end;
    }

    /// Records the outcomes of the messages in transit to `robot` at the end of the run.
    pub fn finish_robot(&mut self, robot: &mut Robot) {
        while let Some(fate) = self.decided.pop_if(|fate| fate.to == robot.id) {
            robot.deliver(fate);
        }
        robot.finish_radio(self.end);
    }

    /// Time of the next slot that must be run for messages even if no robot is due; [`Time::NEVER`] if no message is on
    /// its way.
    pub fn due(&self, channel: &Channel) -> Time {
        self.visible.peek().map_or(Time::NEVER, |Reverse((visible, _))| *visible).min(channel.due())
    }
}
