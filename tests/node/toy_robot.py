"""The driver of a robot that is none: no more than the topics that a training over topics needs."""
import math

import rospy
from geometry_msgs.msg import PointStamped
from threelink_msgs.msg import HingeRates, Observation, SwimmerState
from threelink_msgs.srv import Reset, ResetResponse

DT = 0.1


class ToyRobot:
    """Takes any heading that it likes, its hinges nearly as demanded, and swims as nothing does."""

    def __init__(self, namespace, start_error):
        self.start_error = start_error
        self.state = SwimmerState(episode=0)
        rospy.set_param(namespace + "simulator", {"links": 3})
        publish = lambda name, kind: rospy.Publisher(namespace + name, kind, latch=True,
                                                     queue_size=10, tcp_nodelay=True)
        listen = lambda name, kind, heard: rospy.Subscriber(namespace + name, kind, heard,
                                                            tcp_nodelay=True)
        self.states = publish("state", SwimmerState)
        self.observations = publish("observation", Observation)
        self.parts = [rospy.Service(namespace + "reset", Reset, self.reset), self.states,
                      self.observations, listen("target", PointStamped, self.on_target),
                      listen("hinge_rates", HingeRates, self.on_rates)]

    def end(self):
        for part in self.parts:
            (part.shutdown if isinstance(part, rospy.Service) else part.unregister)()

    def reset(self, request):
        self.state = SwimmerState(episode=self.state.episode + 1, hinge_rates=[0, 0])
        self.state.alpha = [angle - math.copysign(self.start_error, angle)
                            for angle in request.alpha]
        self.tell_state(heading=0.3 * self.state.episode)
        return ResetResponse(success=True, state=self.state)

    def tell_state(self, heading):
        first, second = self.state.alpha
        self.state.theta = [heading - first, heading, heading + second]
        self.state.header.stamp.nsecs += 1
        self.states.publish(self.state)

    def on_target(self, target):
        state, seen = self.state, Observation(kind="direction")
        seen.header, seen.episode, seen.step = state.header, state.episode, state.step
        self.direction = math.atan2(target.point.y - state.centroid[1],
                                    target.point.x - state.centroid[0])
        angle = state.theta[1] - self.direction
        seen.values = [math.cos(angle), math.sin(angle)] + list(state.alpha)
        self.observations.publish(seen)

    def on_rates(self, message):
        state, limit = self.state, 2 * math.pi / 3
        if (message.episode, message.step) != (state.episode, state.step):
            return
        wanted = [a + DT * rate for a, rate in zip(state.alpha, message.rates)]
        alpha = [max(-limit, min(limit, angle)) for angle in wanted]
        state.hinge_rates = [rate if a == w else (a - old) / DT for rate, a, w, old in
                             zip(message.rates, alpha, wanted, state.alpha)]
        state.alpha = alpha
        ahead = 0.01 * state.hinge_rates[0]
        heading = state.theta[1]
        state.centroid = [state.centroid[0] + ahead * math.cos(heading),
                          state.centroid[1] + ahead * math.sin(heading)]
        state.reward = 6 * ahead * math.cos(heading - self.direction)
        state.step += 1
        self.tell_state(heading + 0.02 * state.hinge_rates[1])
