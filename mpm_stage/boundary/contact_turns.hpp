// All contacts of one node, taken in turn until none changes any more: between bodies (field_contact.hpp) and of each
// with the ground (ground_push.hpp).
//
// They have to be solved as one. Were the bodies parted first, a light node that the soil above drives into the ground
// would push its neighbour aside, and itself off it, with every step: 6 MJ a second in the Mochikoshi case on cells
// of 4 m. Were the ground first and last, a body that another one presses on it would not pass on the push.
#pragma once

#include <algorithm>

#include "mpm_stage/boundary/field_contact.hpp"
#include "mpm_stage/boundary/ground_push.hpp"

namespace tailrun::mpm {

// Turns at most, and the change of impulses over the largest one that counts as none. A light layer between heavy
// bodies passes on little with each turn.
constexpr int most_turns = 30;
constexpr double no_change = 1e-6;

// Between the bodies alone. One pair needs no second turn.
template <int Dim>
void settle(ContactPairs<Dim>& pairs) {
  const double first = pairs.press();
  for (int turn = 1; turn < most_turns && pairs.count() > 1; ++turn)
    if (pairs.press() <= no_change * first) return;
}

// `ground` is what pushes each of the `count` bodies at which the pairs point. It has the last word: what is left after
// the last turn is an approach of bodies.
template <int Dim>
void settle(ContactPairs<Dim>& pairs, BodyAtNode<Dim>* body, GroundPush<Dim>* ground, int count) {
  const auto press_on_ground = [=] {
    double change = 0.0;
    for (int b = 0; b < count; ++b) change += ground[b].press(body[b].v);
    return change;
  };
  double largest = press_on_ground();
  for (int turn = 0; turn < most_turns; ++turn) {
    double change = pairs.press();
    if (change > 0.0) change += press_on_ground();
    if (change <= no_change * largest) return;
    largest = std::max(largest, change);
  }
}

}  // namespace tailrun::mpm
