"""The L1 law of ArduPlane (AP_L1_Control::update_waypoint, Plane::verify_nav_wp), the law of PX4
(DirectionalGuidance::guideToPath), and a wing that banks late and slips, by the text of src/verify/execute/wing/mod.rs: integrated as differential equations, not in the steps of the verdict."""

import math

import numpy as np

from .flight import G

STEP_S, JUDGED_S = 0.05, 0.5
WAY_M = 0.5  # a way that is nearer to its legs is not judged
TURNING_SHARE, BANK_LAG_S, FASTER_SHARE, SLOWER_SHARE = 0.7, 0.5, 0.08, 0.1
INTEGRAL_GAIN, INTEGRAL_RAD, INTEGRAL_WITHIN_RAD = 0.02, 0.1, math.radians(5)
LEAD_S = 1.0
EITHER_WAY_RAD = math.radians(170)
SINE_45 = math.sqrt(0.5)


def within(value, limit):
    """The nearest value between -limit and limit."""
    return -limit if value < -limit else limit if value > limit else value


def air_ratio(amsl):
    return (1 - 2.25577e-5 * amsl) ** -2.12794


class Leg:
    """East and north, seen from the beginning of the leg: along it, and to the right of it."""

    def __init__(self, a, b):
        self.a, self.b = (float(a[0]), float(a[1])), (float(b[0]), float(b[1]))
        east, north = self.b[0] - self.a[0], self.b[1] - self.a[1]
        self.length = math.hypot(east, north)
        self.east, self.north = east / self.length, north / self.length
        self.course = math.atan2(east, north)

    def off(self, east, north):
        e, n = east - self.a[0], north - self.a[1]
        return e * self.east + n * self.north, e * self.north - n * self.east

    def distance(self, east, north):
        along, right = self.off(east, north)
        if 0.0 <= along <= self.length:
            return abs(right)
        return math.hypot(right, max(-along, along - self.length))

    def turn(self, onto):
        return abs((onto.course - self.course + math.pi) % (2 * math.pi) - math.pi)


def moved(state, time, rates):
    """The state after a time at constant rates."""
    x, y, heading, bank, integral = state
    dx, dy, turning, rolling, gathering = rates
    return x + time * dx, y + time * dy, heading + time * turning, bank + time * rolling, integral + time * gathering


class Law:
    turning_share = TURNING_SHARE
    pace = 1.0  # speed through the air, as a share of that of the leg
    side = 1  # where the course is more than 170 degrees off, it turns to the left
    may_turn_either_way = False  # whether its last way had such a place
    turns_back = False  # whether one of PX4 had: the step at which it is 150 degrees off decides where, up to 9 m were seen

    paces = 1.0, 1.0 + FASTER_SHARE

    def __init__(self, params, load_factor):
        self.period, self.damping = params.get("NAVL1_PERIOD", 17.0), params.get("NAVL1_DAMPING", 0.75)
        self.radius = params.get("WP_RADIUS", 90.0)
        limit = params.get("ROLL_LIMIT_DEG")
        self.limit = math.acos(1 / load_factor) if limit is None else math.radians(limit)

    def ahead(self, speed):
        return self.damping * self.period * speed / math.pi

    def before(self, turn, speed, amsl):
        """So far before a waypoint it takes the next leg."""
        return min(self.radius * air_ratio(amsl) ** 2, self.ahead(speed)) * min(turn / (math.pi / 2), 1.0)

    def rates(self, state, leg, air, wind):
        """Changes of east, north, heading, bank and integral, a second."""
        _, _, heading, bank, integral = state
        east, north = air * math.sin(heading) + wind[0], air * math.cos(heading) + wind[1]
        speed = math.hypot(east, north)
        length = self.ahead(speed)
        _, right = leg.off(state[0], state[1])
        # Both positive where the wing is to be turned to the left.
        nu1 = math.asin(within(right / length, SINE_45))
        nu2 = math.atan2(east * leg.north - north * leg.east, east * leg.east + north * leg.north)
        if abs(nu2) > EITHER_WAY_RAD:
            self.may_turn_either_way = True
            nu2 = self.side * abs(nu2)
        nu = within(nu1 + integral + nu2, math.pi / 2)
        across = 4 * self.damping**2 * speed**2 / length * math.sin(nu)
        asked = within(math.atan(across / G), self.limit)
        gathers = INTEGRAL_GAIN * nu1 if abs(nu1) < INTEGRAL_WITHIN_RAD else 0.0
        if abs(integral) >= INTEGRAL_RAD and gathers * integral > 0:
            gathers = 0.0
        return east, north, -self.turning_share * G * math.tan(bank) / air, (asked - bank) / BANK_LAG_S, gathers

    def both(self, fly):
        """What it flies as fast as planned, and faster, to the left and to the right where it may turn either way."""
        for self.pace in self.paces:
            yield from self.sides(fly)
        self.pace = 1.0

    def sides(self, fly):
        """What it flies, and to the other side where it may turn either way."""
        self.side, self.may_turn_either_way = 1, False
        yield fly(self)
        if self.may_turn_either_way:
            self.side = -1
            yield fly(self)
            self.side = 1

    def follow(self, flat, amsl, speeds, wind, judged=JUDGED_S):
        """The way along legs from the first place on the course of the first leg, half a second or so at a time:
        from, to, the leg that it follows at the end, and the furthest from that and the leg before."""
        legs = [Leg(a, b) for a, b in zip(flat, flat[1:])]
        turns = [a.turn(b) for a, b in zip(legs, legs[1:])]
        return self.fly(legs, turns, amsl, speeds, wind, legs[0].a, judged=judged)

    def leave(self, course, flat, amsl, speeds, wind):
        """The way of a plane that has its height at the first place, on a heading: straight at the next from wherever it
        is, and along the legs from there."""
        legs = [Leg(a, b) for a, b in zip(flat, flat[1:])]
        turns = [a.turn(b) for a, b in zip(legs, legs[1:])]
        return self.fly(legs, turns, amsl, speeds, wind, legs[0].a, heading=course)

    def arrive(self, start, from_place, flat, amsl, speeds, wind):
        """The way of a wing that comes to the first place straight from `start`; where it takes the next leg
        it reckons from the leg of the mission."""
        along = Leg(start, flat[0])
        legs = [along] + [Leg(a, b) for a, b in zip(flat, flat[1:])]
        turns = [Leg(from_place, flat[0]).turn(legs[1])] + [a.turn(b) for a, b in zip(legs[1:], legs[2:])]
        back = min(self.before(turns[0], self.pace * speeds[0], amsl[0]) + LEAD_S * speeds[0], along.length)
        begin = along.b[0] - back * along.east, along.b[1] - back * along.north
        way = self.fly(legs, turns, [amsl[0], *amsl], [speeds[0], *speeds], wind, begin, 1)
        return [(a, b, leg - 1, aside) for a, b, leg, aside in way]

    def fly(self, legs, turns, amsl, speeds, wind, begin, first=0, judged=JUDGED_S, heading=None):
        blows = (0.0, 0.0)
        if wind:
            clockwise = math.radians(wind["from_deg"])
            blows = -wind["speed_mps"] * math.sin(clockwise), -wind["speed_mps"] * math.cos(clockwise)
        airs = [self.pace * math.hypot(v * leg.east - blows[0], v * leg.north - blows[1]) for leg, v in zip(legs, speeds)]
        is_homing = heading is not None
        if not is_homing:
            heading = math.atan2(speeds[0] * legs[0].east - blows[0], speeds[0] * legs[0].north - blows[1])
        state = [*begin, heading, 0.0, 0.0]
        t, i, way, since, aside, steps = 0.0, 0, [], None, 0.0, 0
        most = 2 * sum(leg.length / v for leg, v in zip(legs, speeds)) + 60
        before = [self.before(turn, self.pace * v, z) for turn, v, z in zip(turns, speeds, amsl[1:])] + [0.0]
        while t < most:
            leg = legs[i]
            along, _ = leg.off(state[0], state[1])
            if along >= leg.length or math.hypot(state[0] - leg.b[0], state[1] - leg.b[1]) <= before[i]:
                i += 1
                if i == len(legs):
                    break
                continue
            if since is None and i >= first:
                since, aside, steps = (state[0], state[1]), 0.0, 0
            at = Leg(state[:2], leg.b) if is_homing and i == 0 else leg
            middle = moved(state, STEP_S / 2, self.rates(state, at, airs[i], blows))
            at = Leg(middle[:2], leg.b) if is_homing and i == 0 else leg
            state = moved(state, STEP_S, self.rates(middle, at, airs[i], blows))
            t += STEP_S
            if since is not None:
                steps += 1
                off = leg.distance(state[0], state[1])
                if i > 0 and off > aside:
                    off = min(off, legs[i - 1].distance(state[0], state[1]))
                aside = max(aside, off)
                if steps * STEP_S >= judged - 1e-9:
                    here = state[0], state[1]
                    way.append((np.array(since), np.array(here), i, aside))
                    since, aside, steps = here, 0.0, 0
        return way


class Px4Law(Law):
    turning_share = 0.95
    side = 1  # where the heading is more than 150 degrees off, it turns to the right
    early = False  # takes the next leg within the switch distance, as 1.18 does

    def __init__(self, params, load_factor, is_windy):
        self.paces = (1.0, 1.0 - SLOWER_SHARE) if is_windy else (1.0,)
        self.time = params.get("NPFG_PERIOD", 10.0) * params.get("NPFG_DAMPING", 0.7)
        self.switch, self.accept = params.get("NPFG_SW_DST_MLT", 0.32), params.get("NAV_ACC_RAD", 10.0)
        limit = params.get("FW_R_LIM")
        self.limit = math.acos(1 / load_factor) if limit is None else math.radians(limit)

    def ahead(self, speed):
        return self.time * max(speed, 1.0)

    def before(self, turn, speed, amsl):
        return max(self.accept, self.switch * self.ahead(speed)) if self.early else self.accept

    def rates(self, state, leg, air, wind):
        _, _, heading, bank, _ = state
        east, north = air * math.sin(heading) + wind[0], air * math.cos(heading) + wind[1]
        bound = self.ahead(math.hypot(east, north))
        along, right = leg.off(state[0], state[1])
        off = math.hypot(along, right)
        if along < 0 and off > self.switch * bound:
            course = math.atan2(leg.a[0] - state[0], leg.a[1] - state[1])
        else:
            share = min(abs(right) / bound, 1.0)
            course = leg.course - math.copysign(math.pi / 2 * (1 - (1 - share) ** 2), right)
        # The wind from the right of the course turns the heading to the right of it.
        from_right = -(wind[0] * math.cos(course) - wind[1] * math.sin(course))
        asked = course + math.asin(within(from_right / air, 1.0))
        error = (asked - heading + math.pi) % (2 * math.pi) - math.pi
        if abs(error) > math.radians(150):
            self.may_turn_either_way = self.turns_back = True
            error = self.side * abs(error)
        across = 0.8885 * air * math.sin(within(error, math.pi / 2))
        roll = within(math.atan(across / G), self.limit)
        return east, north, self.turning_share * G * math.tan(bank) / air, (roll - bank) / BANK_LAG_S, 0.0

    def both(self, fly):
        """What it flies as fast as planned, and slower in wind, to the right and to the left where it may turn either way, and
        as 1.17 and 1.18 take the next leg: these missions do not say their version."""
        for self.pace in self.paces:
            for self.early in (False, True):
                yield from self.sides(fly)
        self.pace = 1.0
