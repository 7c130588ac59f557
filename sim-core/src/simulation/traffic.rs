//! Messages at the end of a slot: passes sent messages to the channel, and their outcomes to the affected robots.

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
    /// Messages that have left the buffers of their senders by the end of the slot: (sender, sequence number).
    departed: Vec<(RobotId, u64)>,
    /// Times when messages become visible, with their receivers.
    visible: BinaryHeap<Reverse<(Time, RobotId)>>,
    /// End of the run.
    end: Time,
}

impl Traffic {
    /// Takes the messages that `robot` has sent in the slot that ends, and reports to the channel if its radio was
    /// switched.
    pub fn collect(&mut self, robot: &mut Robot, channel: &mut Channel) {
        let Some(station) = &mut robot.station else { return };
        if let Some(change) = station.take_change() {
            channel.report_change(change);
        }
        self.messages.append(&mut station.take_outgoing());
    }

    /// Makes the channel decide the messages up to `slot_end`. Adds to `affected` the robots that the outcomes affect
    /// and the robots for which a message has become visible.
    pub fn exchange(&mut self, slot_end: Time, channel: &mut Channel, affected: &mut Vec<RobotId>) {
        if !self.messages.is_empty() || channel.due() <= slot_end {
            self.decided = channel.exchange(slot_end, std::mem::take(&mut self.messages));
            // Removes most duplicates: deliveries to the same robot are often adjacent.
            affected.extend(self.decided.chunk_by(|one, other| one.to == other.to).map(|chunk| chunk[0].to));
            self.departed = channel.take_transmitted();
            affected.extend(self.departed.iter().map(|(robot, _)| *robot));
        }
        while let Some(Reverse((visible, robot))) = self.visible.peek()
            && *visible < slot_end
        {
            affected.push(*robot);
            self.visible.pop();
        }
    }

    /// Delivers the outcomes of the slot that ends. `robots` must include the robots that [`Traffic::exchange`] has
    /// added, in the order of their ids. Returns the receivers of messages, each with the time when the message becomes
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

    /// Ends the run at `end`: messages whose outcome `channel` has not decided are lost.
    pub fn finish(&mut self, end: Time, channel: &mut Channel) {
        self.decided = channel.finish(end);
        // Reversed, because `finish_robot` removes elements from the end and is called for the first robot first.
        self.decided.reverse();
        self.end = end;
    }

    /// Records the outcomes of the messages that are in transit to `robot` at the end of the run.
    pub fn finish_robot(&mut self, robot: &mut Robot) {
        while let Some(delivery) = self.decided.pop_if(|delivery| delivery.to == robot.id) {
            robot.deliver(delivery);
        }
        robot.finish_radio(self.end);
    }

    /// Next instant whose slot must be run for messages even if no robot is due; [`Time::NEVER`] if no message is in
    /// transit.
    pub fn due(&self, channel: &Channel) -> Time {
        self.visible.peek().map_or(Time::NEVER, |Reverse((visible, _))| *visible).min(channel.due())
    }
}
