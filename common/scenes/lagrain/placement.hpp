// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `place_grains` decides where the grains of a scene are at time 0.

#include <lagrain/grains.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/scene.hpp>
#include <lagrain/walls.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace lagrain {

/// Called again and again while grains are placed: with how many are, and how many there will be as
/// far as the scene says it. What it throws ends the placing; empty where nobody waits.
using PlacementWatch = std::function<void(std::int64_t placed, std::int64_t asked)>;

/// What contacts remembered in the run that a scene starts from. A column is of a contact.
struct RecalledContacts {
  std::vector<Pair> pairs;  ///< of grains, by place in the placement
  /// Of these, as the first sees it; how many numbers each has is the law's affair.
  Eigen::MatrixXd memories;
  std::vector<WallPair> at_walls;  ///< the same for walls of the scene
  Eigen::MatrixXd wall_memories;   ///< of these
};

/// Grains and walls of a scene at time 0: the grains of the run that it starts from, those placed
/// by hand, those of files, then the fills, all in the scene's order.
template <int Dim>
struct Placement {
  std::vector<Grain<Dim>> grains;  ///< N
  std::vector<int> group;          ///< N: index into the scene's fills; -1 for all other grains
  std::vector<Wall<Dim>> walls;    ///< the scene's; pistons stand where that run has left them
  RecalledContacts recalled;       ///< from that run, if its laws are those of the scene
  std::string origin;              ///< what comes from there, in words; empty if nothing does
};

/// Places the grains and checks them.
///
/// A lattice fills its region row by row from the bottom (the last axis points up), in cells of the
/// group's largest diameter and a little room for a seeded jitter; cells that a wall or an earlier
/// grain already takes are passed over. A random arrangement tries places until one is free, large
/// grains first. Grains that find none are placed at random all the same, and everything that was
/// placed at random in the same region, by this fill or an earlier one, is pushed apart; all other
/// grains stay. Nothing overlaps in the end, be it of materials that touch or not; only grains
/// placed by hand or listed in files may overlap what they do not touch, and grains of a run that
/// the scene starts from overlap as they did there.
///
/// @throws SceneError if a region does not hold its grains (the message says how many a lattice
/// held, or which solid fraction was asked for and what the limit is), or if grains placed by hand
/// or listed in files overlap each other or a wall by more than the scene allows, or if a file of
/// grains cannot be read or is wrong (the message names file, line and column), or if there is no
/// such run to start from, or its grains are of a material that the scene does not name, or do not
/// fit between the scene's walls
template <int Dim>
Placement<Dim> place_grains(const Scene<Dim>& scene, const PlacementWatch& watch = {});

}  // namespace lagrain
