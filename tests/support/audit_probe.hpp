// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Gives tests access to private members: they plant errors there, which audits have to find.

#include <cstddef>

namespace lagrain {

/// Every class that can be audited names this one as a friend.
struct AuditProbe {
  // Triangulations.
  static auto& topology(auto& t) { return t.topology_; }
  static auto& edges(auto& t) { return t.edges_; }
  static auto& hidden(auto& t) { return t.hidden_; }
  static auto& sites(auto& t) { return t.sites_; }
  static auto& places_before(auto& t) { return t.before_; }
  static auto& present(auto& t) { return t.present_; }
  static auto& dimension(auto& t) { return t.dimension_; }
  static auto& site_note(auto& t) { return t.site_note_; }
  static auto& vertex_note(auto& t) { return t.vertex_note_; }
  static auto& middle(auto& t) { return t.middle_; }
  static auto& thin(auto& t) { return t.thin_; }
  static auto& last(auto& t) { return t.last_; }
  static auto& free_slots(auto& t) { return t.topology_.free_; }
  static auto& mark(auto& t, int simplex) {
    const auto k = static_cast<std::size_t>(simplex);
    if constexpr (requires { t.topology_.mark_; }) {
      return t.topology_.mark_[k];
    } else {
      return t.topology_.triangles_[k].mark;
    }
  }

  // Lists of edges.
  static auto& listed(auto& list) { return list.edges_; }
  static auto& live(auto& list) { return list.live_; }
  static auto& notes(auto& list) { return list.notes_; }
  static auto& first_new(auto& list) { return list.first_new_; }
  static auto& before(auto& list) { return list.before_; }

  // Lists of balls that meet.
  static auto& balls(auto& list) { return list.balls_; }
  static auto& pairs(auto& list) { return list.pairs_; }
  static auto& added(auto& list) { return list.added_; }
  static auto& first(auto& list) { return list.first_; }
  static auto& partners(auto& list) { return list.partners_; }
  static auto& more(auto& list) { return list.more_; }
  static auto& first_edge(auto& list) { return list.first_edge_; }
  static auto& edge_ends(auto& list) { return list.edge_ends_; }
  static auto& first_guest(auto& list) { return list.first_guest_; }
  static auto& guests(auto& list) { return list.guests_; }
  static auto& widest(auto& list) { return list.widest_; }
  static auto& apart(auto& list) { return list.apart_; }
  static auto& stamp(auto& list) { return list.stamp_; }
  static auto& stamps(auto& list) { return list.stamps_; }

  // Near lists and their tables.
  static auto& block_size(auto& list) { return list.block_size_; }
  static auto& across_count(auto& list) { return list.across_; }
  static auto& margin(auto& list) { return list.margin_; }
  static auto& stays(auto& list) { return list.stay_; }
  static auto& listed_walls(auto& list) { return list.listed_walls_; }
  static auto& wall_margin(auto& list) { return list.wall_margin_; }
  static auto& pairs_of_table(auto& table) { return table.pairs_; }
  static auto& memory(auto& table) { return table.memory_; }

  // Triangulations that follow grains.
  static auto& triangulation(auto& n) { return n.sites_.t; }
  static auto& reference(auto& n) { return n.sites_.reference; }
  static auto& weight(auto& n) { return n.sites_.weight; }
  static auto& skin(auto& n) { return n.sites_.skin; }
  static auto& drift(auto& n) { return n.sites_.drift; }
  static auto& uncertain(auto& n) { return n.follower_.uncertain_; }
  static auto& leaping(auto& n) { return n.leaping_; }
  static auto& reach(auto& n) { return n.leaper_.reach_; }
  static auto& spent(auto& n) { return n.spent_; }
  /// Lets a grain wait for a new reference.
  static void join(auto& n, int i) { n.sites_.join(i); }
  /// Lets it wait, but only by its state.
  static void mark_as_waiting(auto& n, int i) {
    n.sites_.join(i);
    n.sites_.waiting.clear();
  }
};

}  // namespace lagrain
