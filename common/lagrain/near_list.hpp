// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `NearList` holds the pairs that are close enough to touch soon, which the step loop runs over,
/// and knows when it has to be made anew.

#include <lagrain/check.hpp>
#include <lagrain/contact_rules.hpp>
#include <lagrain/contact_search.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/pair_table.hpp>
#include <lagrain/state.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace lagrain {

/// All pairs within reach. Each grain has a centre, where it was when it was listed last, and a
/// margin m_i: as long as none has moved further than its margin from its centre, two grains that
/// touch have centres at a gap of at most m_i + m_j, so their pair is in the list. The same holds
/// for walls.
///
/// Displacements are measured in a frame that moves on with the velocity that most grains had at
/// the refresh: a common drift wears nothing out. A margin follows the grain's speed in that frame,
/// so that a bed at rest is listed almost without surplus; the least margin adapts to how many slow
/// grains leave theirs. The choice of margins never changes a result: pairs that do not touch are
/// skipped, and the order of the others is fixed by the grains' slots.
///
/// A *refresh* centres all grains anew. In between, the list is *amended* where grains leave their
/// margins: they alone get new centres and margins, and the pairs that they lack. So one fast grain
/// costs only its surroundings. It does not matter when a centre and a margin were set: the promise
/// rests on their being such that all pairs within reach are listed.
///
/// Slots are dealt with in blocks of equal size, the same whatever the number of threads. Pairs
/// within a block belong to it alone; pairs across blocks are listed apart, and each block has a
/// list of what they do to its grains.
template <int Dim, class Memory>
class NearList {
 public:
  /// Pairs with what their contacts remember, as the first sees it.
  using PairMemories = std::vector<std::pair<Pair, Memory>>;
  using WallMemories = std::vector<std::pair<WallPair, Memory>>;  ///< the same for walls
  /// One end of a pair across blocks.
  struct End {
    int slot;          ///< of this end
    int partner;       ///< the slot of the other end
    std::size_t pair;  ///< its rank among the pairs across of all blocks
    bool second() const { return partner < slot; }  ///< the end j of the pair
    bool operator==(const End&) const = default;
  };
  /// The slots [first_slot, end_slot) and the pairs of their grains.
  struct Block {
    int first_slot = 0;                 ///< where its slots begin
    int end_slot = 0;                   ///< where they end: the next block's first slot
    PairTable<Pair, Memory> within;     ///< both grains are in the block
    PairTable<Pair, Memory> across;     ///< i is in the block, j in a later one
    PairTable<WallPair, Memory> walls;  ///< grains of the block and walls
    std::size_t first_across = 0;       ///< rank of its first pair across
    std::vector<End> ends;  ///< in the block, of pairs across; in the order of the pairs
  };

  /// All blocks, in the order of their slots.
  /// @{
  std::vector<Block>& blocks() { return blocks_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  /// @}
  /// Pairs between grains; and those of them across blocks.
  std::size_t pair_count() const {
    std::size_t count = across_;
    for (const Block& block : blocks_) count += block.within.size();
    return count;
  }
  std::size_t across_count() const { return across_; }  ///< pairs whose grains lie in two blocks

  /// Whether a refresh would pay although the list holds. It has lived long then, and hardly any
  /// slow grain has left its margin: narrower margins would do.
  bool worth_narrowing(std::int64_t step) const {
    return step - last_refresh_ > kLong && floor_ > kLeastFloor && slow_rate(step) < kFew;
  }

  std::int64_t refreshes() const { return refreshes_; }  ///< since the start
  std::int64_t amended() const { return amended_; }      ///< grains centred anew between refreshes
  /// False before the first refresh, and when the grains have new slots.
  bool listed() const { return listed_; }

  /// Sets the number of grains and the size of blocks; nothing is listed.
  void reset(int size, int block_size) {
    size_ = size;
    block_size_ = block_size;
    blocks_.assign(index((size + block_size - 1) / block_size), {});
    int first = 0;
    for (Block& block : blocks_) {
      block.first_slot = first;
      first = block.end_slot = std::min(size, first + block_size);
    }
    across_ = 0;
    listed_ = false;
  }

  /// Says which pairs, by slot, are contacts where they overlap. The others are not listed.
  void set_rules(ContactRules rules) { rules_ = std::move(rules); }
  const ContactRules& rules() const { return rules_; }  ///< by slot

  /// How far the frame has moved since the last refresh, at time t [s].
  Vec<Dim> shift(double t) const { return (t - time_) * drift_; }

  /// Whether a grain at x, where the frame has moved by `shift`, is within its margin. NaN is not.
  /// @pre listed()
  bool holds(int slot, const Vec<Dim>& x, const Vec<Dim>& shift) const {
    const Stay& stay = stay_[index(slot)];
    return (x - shift - stay.centre).squaredNorm() <= stay.squared_margin;
  }

  /// Whether all walls are within their margins, around where they were at the last refresh, and
  /// those are there that were there then.
  /// @pre listed()
  bool walls_hold(const std::vector<Wall<Dim>>& all_walls, const Vec<Dim>& shift) const {
    for (std::size_t w = 0; w < all_walls.size(); ++w) {
      const double way = all_walls[w].way_since(listed_walls_[w].pose(), shift);
      if (!(way <= wall_margin_[w] * kHair)) return false;
      if (all_walls[w].gone != listed_walls_[w].gone) return false;
    }
    return true;
  }

  /// Centres all grains at their places x [m], at time t [s] and step `step` of length dt [s].
  /// @param velocity  velocity(slot) [m/s]
  template <Neighbourhood<Dim> N, class Velocity>
  void refresh(const Columns<Dim>& x, const Eigen::VectorXd& radius, Velocity&& velocity,
               const std::vector<Wall<Dim>>& all_walls, N& neighbourhood, double t, double dt,
               std::int64_t step) {
    adapt(step);
    time_ = t;
    drift_ = common_drift<Dim>(size_, velocity);
    margin_.resize(size_);
    for (int i = 0; i < size_; ++i) margin_[i] = wanted_margin(radius[i], velocity(i), dt);
    neighbourhood.near_pairs(x, radius, margin_, found_);
    rules_.drop_from(found_);
    list_pairs();
    list_walls(x, radius, all_walls, dt);
    stay_.resize(index(size_));
    for (int i = 0; i < size_; ++i) stay(i, x.col(i));
    paid_ = 0;
    listed_ = true;
    ++refreshes_;
    if constexpr (kAudited) {
      if (keeps_promise(neighbourhood)) {
        detail::expect_no_defect("near list, refreshed", audit(radius, all_walls));
      }
    }
  }

  /// Centres the grains anew that have left their margins, and adds the pairs that they lack. What
  /// they need no more stays listed until the next refresh.
  /// @param strays    those grains; others may be added
  /// @param place     place(slot) [m]
  /// @param velocity  velocity(slot) [m/s]
  /// @returns false if a refresh is due: the neighbourhood cannot tell without, or the amendments
  ///          since the last one have cost as much as it does
  /// @pre listed(), and the walls hold
  template <AmendableNeighbourhood<Dim> N, class Place, class Velocity>
  bool amend(std::vector<int>& strays, Place&& place, Velocity&& velocity,
             const Eigen::VectorXd& radius, const std::vector<Wall<Dim>>& all_walls,
             N& neighbourhood, double t, double dt) {
    const Vec<Dim> shift = this->shift(t);
    const auto place_here = [&](int i) -> Vec<Dim> { return place(i) - shift; };
    for (const int i : strays) {
      if (!place(i).allFinite()) return false;
      slow_ += margin_[i] <= floor_ * radius[i];
      margin_[i] = wanted_margin(radius[i], velocity(i), dt);
    }
    paid_ += kPriceOfStray * static_cast<std::int64_t>(strays.size());
    if (paid_ > kPriceOfRefresh * size_ ||
        !neighbourhood.pairs_of(strays, place_here, radius, margin_, found_)) {
      return false;
    }
    rules_.drop_from(found_);
    std::erase_if(found_, [&](const Pair& pair) { return surely_listed(pair, radius); });
    for (const int i : strays) stay(i, place_here(i));
    bool ends_change = false;
    for (const Pair& pair : found_) {
      const auto [i, j] = pair;
      if (!within_reach<Dim>(stay_[index(i)].centre, radius[i] + margin_[i], stay_[index(j)].centre,
                             radius[j] + margin_[j])) {
        continue;
      }
      Block& block = block_of(i);
      const bool inside = j < block.end_slot;
      ends_change |= insert(inside ? block.within : block.across, pair) && !inside;
    }
    if (ends_change) list_ends();
    for (const int i : strays) {
      for (std::size_t w = 0; w < all_walls.size(); ++w) {
        if (!rules_.may_touch(i, all_walls[w])) continue;
        // In the frame at the last refresh, and with the wall as it was then.
        listed_walls_[w].for_each_near(stay_[index(i)].centre,
                                       radius[i] + margin_[i] + wall_reach(w), near_pieces_,
                                       [&](int piece) {
                                         insert(block_of(i).walls, {i, static_cast<int>(w), piece});
                                       });
      }
    }
    amended_ += static_cast<std::int64_t>(strays.size());
    if constexpr (kAudited) {
      if (keeps_promise(neighbourhood)) {
        detail::expect_no_defect("near list, amended", audit(radius, all_walls));
      }
    }
    return true;
  }

  /// The grains have new slots: the memories follow, and the list waits for a refresh.
  /// @param slot        new slot of each old one; -1 where the grain has left
  /// @param size        number of grains from now on
  /// @param block_size  of slots from now on
  void renumber(const std::vector<int>& slot, int size, int block_size) {
    auto [pairs, wall_pairs] = memories();
    recall(std::move(pairs), std::move(wall_pairs), slot, size, block_size);
  }

  /// Contacts remember what these entries say, and no others anything; after that the list waits
  /// for a refresh.
  /// @param slot        by which the grains that the entries name go from now on; -1 for none
  /// @param size        number of grains from now on
  /// @param block_size  of slots from now on
  void recall(PairMemories pairs, WallMemories wall_pairs, const std::vector<int>& slot, int size,
              int block_size) {
    for (auto& [pair, memory] : pairs) {
      pair = {slot[index(pair.i)], slot[index(pair.j)]};
      if (pair.i > pair.j) {
        std::swap(pair.i, pair.j);
        memory = memory.seen_from_partner();
      }
    }
    std::erase_if(pairs, [](const auto& entry) { return entry.first.i < 0; });
    for (auto& entry : wall_pairs) entry.first.i = slot[index(entry.first.i)];
    std::erase_if(wall_pairs, [](const auto& entry) { return entry.first.i < 0; });
    deal(std::move(pairs), std::move(wall_pairs), size, block_size);
  }

  /// Keeps or restores what contacts remember; after that the list waits for a refresh.
  /// @param size        number of grains from now on
  /// @param block_size  of slots from now on
  /// @throws SceneError if the state holds no such memories
  void persist(const StateVisitor& visit, int size, int block_size) {
    if constexpr (Memory::kReals > 0) {
      auto [pairs, wall_pairs] = memories();
      persist_memories(visit.in("contacts"), pairs,
                       [&](const Pair& p) { return 0 <= p.i && p.i < p.j && p.j < size; });
      persist_memories(visit.in("wall_contacts"), wall_pairs,
                       [&](const WallPair& p) { return 0 <= p.i && p.i < size; });
      if (visit.restores()) deal(std::move(pairs), std::move(wall_pairs), size, block_size);
    } else if (visit.restores()) {
      reset(size, block_size);
    }
  }

  /// Checks what is listed against a search from nothing, and what is kept beside it; empty means
  /// valid. (That grains are within their margins is for `holds` to say.)
  /// @pre listed()
  std::vector<std::string> audit(const Eigen::VectorXd& radius,
                                 const std::vector<Wall<Dim>>& all_walls) const {
    std::vector<std::string> defects;
    if (listed_walls_.size() != all_walls.size() || wall_margin_.size() != all_walls.size() ||
        stay_.size() != index(size_) || margin_.size() != size_) {
      return {"the parts of the list do not fit together"};
    }
    audit_blocks(defects);
    if (!defects.empty()) return defects;
    audit_pairs(radius, defects);
    audit_walls(radius, all_walls, defects);
    return defects;
  }

 private:
  friend struct AuditProbe;

  // The numbers below change no result, only how often lists are made anew and how many of their
  // pairs are too far apart to touch. They were chosen by the time of a whole step on the beds of
  // `bench_lagrain`, settled and shaken. What a factor of two does to each was not measured. Lists
  // take about a tenth of a step (its column neighbourhood_%), and margins adapt to how long lists
  // live, so no more than a few percent are at stake.

  /// Steps that a grain may keep its speed before it is listed anew.
  static constexpr double kHorizon = 100;
  /// The largest margin, of a radius: wider lists cost more than the refreshes that they spare.
  static constexpr double kCeiling = 0.3;
  /// Between these, of a radius, lies the floor: the margin of slow grains.
  static constexpr double kLeastFloor = 1e-4, kMostFloor = 0.1;
  /// The floor grows by kWiden where lists live for fewer than kShort steps, or more than kMany of
  /// all slow grains leave their margins in a step. It shrinks by kNarrow where lists live for more
  /// than kLong steps and fewer than kFew leave.
  static constexpr std::int64_t kShort = 30, kLong = 60;
  static constexpr double kFew = 2e-5, kMany = 2e-4;
  static constexpr double kWiden = 1.25, kNarrow = 0.4;

  /// Prices in units of about 3 ns: to centre one grain anew between refreshes, and in a refresh,
  /// each. To insert a pair moves half of a table, one unit for an entry. A refresh is due when
  /// amendments have cost as much as one, so they never cost more than twice the better choice;
  /// with prices wrong by a factor of two it would be three times.
  static constexpr std::int64_t kPriceOfStray = 500;
  static constexpr std::int64_t kPriceOfRefresh = 50;

  /// The margins used are a hair wider than those promised: rounding in the tests cannot matter.
  static constexpr double kHair = 1 - 1e-6;

  struct Stay {
    Vec<Dim> centre;
    double squared_margin;
  };

  template <class I>
  static std::size_t index(I i) {
    return static_cast<std::size_t>(i);
  }

  /// Lists that die young, or that many slow grains leave, ask for wider margins; those that live
  /// long with few amendments for narrower.
  void adapt(std::int64_t step) {
    if (refreshes_ > 0) {
      if (step - last_refresh_ < kShort || slow_rate(step) > kMany) {
        floor_ = std::min(floor_ * kWiden, kMostFloor);
      } else if (worth_narrowing(step)) {
        floor_ = std::max(floor_ * kNarrow, kLeastFloor);
      }
    }
    slow_ = 0;
    last_refresh_ = step;
  }

  /// Grains that left margins set by the floor, of all grains, per step.
  double slow_rate(std::int64_t step) const {
    return static_cast<double>(slow_) /
           (static_cast<double>(size_) * static_cast<double>(step - last_refresh_));
  }

  /// What a grain may move by before it must be centred anew [m].
  double wanted_margin(double radius, const Vec<Dim>& velocity, double dt) const {
    return std::clamp(kHorizon * dt * (velocity - drift_).norm(), floor_ * radius,
                      kCeiling * radius);
  }

  /// A grain is to stay within its margin around x, in the frame at the last refresh.
  void stay(int i, const Vec<Dim>& x) {
    const double margin = margin_[i] * kHair;
    stay_[index(i)] = {x, margin * margin};
  }

  /// Whether two grains were within reach when they were centred last: then their pair is listed.
  bool surely_listed(const Pair& pair, const Eigen::VectorXd& radius) const {
    const Stay &a = stay_[index(pair.i)], &b = stay_[index(pair.j)];
    return within_reach<Dim>(a.centre, radius[pair.i] + std::sqrt(a.squared_margin), b.centre,
                             radius[pair.j] + std::sqrt(b.squared_margin));
  }

  /// Those of the pairs that remember anything: not all bits of their memories are zero.
  std::pair<PairMemories, WallMemories> memories() const {
    PairMemories pairs;
    WallMemories wall_pairs;
    const auto collect = [&](const auto& table, auto& entries) {
      for (std::size_t k = 0; k < table.size(); ++k) {
        const Memory memory = table.memory(k);
        bool remembers = false;
        if constexpr (Memory::kReals > 0) {
          for (int r = 0; r < Memory::kReals; ++r) {
            remembers = remembers || memory[r] != 0 || std::signbit(memory[r]);
          }
        }
        if (remembers) entries.emplace_back(table.pairs()[k], memory);
      }
    };
    for (const Block& block : blocks_) {
      collect(block.within, pairs);
      collect(block.across, pairs);
      collect(block.walls, wall_pairs);
    }
    return {std::move(pairs), std::move(wall_pairs)};
  }

  /// Keeps or restores pairs and memories, each in a row.
  /// @param sound  whether a pair can be one
  template <class P, class Sound>
  static void persist_memories(StateVisitor visit, std::vector<std::pair<P, Memory>>& entries,
                               Sound&& sound) {
    std::vector<std::int32_t> first(entries.size()), second(entries.size()), piece(entries.size());
    Eigen::Matrix<double, Memory::kReals, Eigen::Dynamic> memory(
        Memory::kReals, static_cast<Eigen::Index>(entries.size()));
    constexpr bool with_wall = std::is_same_v<P, WallPair>;
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const P& pair = entries[k].first;
      first[k] = pair.i;
      if constexpr (with_wall) {
        second[k] = pair.wall;
        piece[k] = pair.piece;
      } else {
        second[k] = pair.j;
      }
      for (int r = 0; r < Memory::kReals; ++r) {
        memory(r, static_cast<Eigen::Index>(k)) = entries[k].second[r];
      }
    }
    visit("slot", first);
    visit(with_wall ? "wall" : "partner", second);
    if (with_wall) visit("piece", piece);
    visit("memory", memory);
    if (!visit.restores()) return;
    if (second.size() != first.size() || memory.cols() != static_cast<Eigen::Index>(first.size()) ||
        (with_wall && piece.size() != first.size())) {
      throw SceneError("its contacts do not fit together");
    }
    entries.resize(first.size());
    for (std::size_t k = 0; k < entries.size(); ++k) {
      if constexpr (with_wall) {
        entries[k].first = {first[k], second[k], piece[k]};
      } else {
        entries[k].first = {first[k], second[k]};
      }
      if (!sound(entries[k].first)) throw SceneError("a contact of it is of no two of its grains");
      for (int r = 0; r < Memory::kReals; ++r) {
        entries[k].second[r] = memory(r, static_cast<Eigen::Index>(k));
      }
    }
  }

  /// Begins anew with these pairs and memories.
  void deal(PairMemories pairs, WallMemories wall_pairs, int size, int block_size) {
    sort_by_pair(pairs);
    sort_by_pair(wall_pairs);
    reset(size, block_size);
    auto pair = pairs.cbegin();
    auto wall_pair = wall_pairs.cbegin();
    for (Block& block : blocks_) {
      const auto last = std::find_if(
          pair, pairs.cend(), [&](const auto& entry) { return entry.first.i >= block.end_slot; });
      const auto inside = [&](const Pair& p) { return p.j < block.end_slot; };
      assign(block.within, pair, last, inside);
      assign(block.across, pair, last, std::not_fn(inside));
      pair = last;
      const auto last_wall = std::find_if(wall_pair, wall_pairs.cend(), [&](const auto& entry) {
        return entry.first.i >= block.end_slot;
      });
      assign(block.walls, wall_pair, last_wall, [](const WallPair&) { return true; });
      wall_pair = last_wall;
    }
    list_ends();
  }

  template <class P>
  static void sort_by_pair(std::vector<std::pair<P, Memory>>& entries) {
    std::sort(entries.begin(), entries.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
  }

  /// Fills a table with those of the entries, in order, that fulfil a condition.
  template <class P, class Entry, class Condition>
  static void assign(PairTable<P, Memory>& table, Entry first, Entry last, Condition&& condition) {
    std::vector<P> keys;
    std::vector<Memory> memories;
    for (; first != last; ++first) {
      if (!condition(first->first)) continue;
      keys.push_back(first->first);
      memories.push_back(first->second);
    }
    table.assign(std::move(keys), memories);
  }

  /// How far beyond a grain and its margin a piece of wall w is listed [m]: what a contact may be
  /// left to is listed as well, see contact_foot.
  double wall_reach(std::size_t w) const { return wall_margin_[w] + 2 * listed_walls_[w].seam; }

  Block& block_of(int slot) { return blocks_[index(slot / block_size_)]; }

  /// Puts found_ into the blocks' tables.
  void list_pairs() {
    auto pair = found_.cbegin();
    for (Block& block : blocks_) {
      found_within_.clear();
      found_across_.clear();
      for (; pair != found_.cend() && pair->i < block.end_slot; ++pair) {
        (pair->j < block.end_slot ? found_within_ : found_across_).push_back(*pair);
      }
      block.within.replace(found_within_);
      block.across.replace(found_across_);
    }
    list_ends();
  }

  /// Tells the blocks of their pairs across.
  void list_ends() {
    across_ = 0;
    for (Block& block : blocks_) block.ends.clear();
    for (Block& block : blocks_) {
      block.first_across = across_;
      for (const auto [i, j] : block.across.pairs()) {
        block.ends.push_back({i, j, across_});
        block_of(j).ends.push_back({j, i, across_});
        ++across_;
      }
    }
  }

  /// Blocks share out the slots and own their pairs; their ends are those of the pairs across.
  void audit_blocks(std::vector<std::string>& defects) const {
    int first = 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Block& block = blocks_[b];
      const auto inside = [&](int slot) {
        return block.first_slot <= slot && slot < block.end_slot;
      };
      const auto all_of = [](const auto& pairs, const auto& is) {
        return std::all_of(pairs.begin(), pairs.end(), is);
      };
      const bool sound =
          block.first_slot == first && first == static_cast<int>(b) * block_size_ &&
          inside(first) && block.end_slot <= size_ && block.within.sound() &&
          block.across.sound() && block.walls.sound() &&
          all_of(block.within.pairs(),
                 [&](const Pair& pair) {
                   return pair.i < pair.j && inside(pair.i) && inside(pair.j);
                 }) &&
          all_of(block.across.pairs(),
                 [&](const Pair& pair) {
                   return inside(pair.i) && pair.j >= block.end_slot && pair.j < size_;
                 }) &&
          all_of(block.walls.pairs(), [&](const WallPair& pair) {
            return inside(pair.i) && pair.wall >= 0 && index(pair.wall) < listed_walls_.size() &&
                   pair.piece >= 0 && pair.piece < listed_walls_[index(pair.wall)].piece_count();
          });
      if (!sound) defects.push_back("block " + std::to_string(b) + " is not sound");
      first = block.end_slot;
    }
    if (first != size_) defects.push_back("blocks do not share out the slots");
    if (!defects.empty()) return;

    NearList listed_anew = *this;
    listed_anew.list_ends();
    if (across_ != listed_anew.across_) defects.push_back("the number of pairs across is wrong");
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Block& anew = listed_anew.blocks_[b];
      if (blocks_[b].ends == anew.ends && blocks_[b].first_across == anew.first_across) continue;
      defects.push_back("the ends of block " + std::to_string(b) + " are out of date");
    }
  }

  /// All pairs within reach of centres and margins are listed.
  void audit_pairs(const Eigen::VectorXd& radius, std::vector<std::string>& defects) const {
    Columns<Dim> centre(Dim, size_);
    for (int i = 0; i < size_; ++i) {
      centre.col(i) = stay_[index(i)].centre;
      const double margin = margin_[i] * kHair;
      if (!(margin_[i] >= 0) || stay_[index(i)].squared_margin != margin * margin) {
        defects.push_back("slot " + std::to_string(i) + " stays within another margin");
      }
    }
    std::vector<Pair> listed;
    for (const Block& block : blocks_) {
      for (const auto* table : {&block.within, &block.across}) {
        listed.insert(listed.end(), table->pairs().begin(), table->pairs().end());
      }
    }
    std::sort(listed.begin(), listed.end());
    ContactSearch<Dim> search;
    for (const Pair& pair : search.find(centre, radius + margin_)) {
      if (!rules_.may_touch(pair)) continue;
      if (std::binary_search(listed.begin(), listed.end(), pair)) continue;
      defects.push_back("slots " + std::to_string(pair.i) + " and " + std::to_string(pair.j) +
                        " are within reach and not listed");
    }
  }

  void audit_walls(const Eigen::VectorXd& radius, const std::vector<Wall<Dim>>& all_walls,
                   std::vector<std::string>& defects) const {
    for (std::size_t w = 0; w < all_walls.size(); ++w) {
      for (const Block& block : blocks_) {
        for (int i = block.first_slot; i < block.end_slot; ++i) {
          if (!rules_.may_touch(i, all_walls[w]) || listed_walls_[w].gone) continue;
          const double margin = (margin_[i] + wall_margin_[w]) * kHair;
          for (int piece = 0; piece < all_walls[w].piece_count(); ++piece) {
            // Where the wall was when it was listed.
            const double distance = listed_walls_[w].foot(piece, stay_[index(i)].centre).distance;
            if (!(distance <= radius[i] + margin)) continue;
            const auto& pairs = block.walls.pairs();
            if (std::binary_search(pairs.begin(), pairs.end(),
                                   WallPair{i, static_cast<int>(w), piece})) {
              continue;
            }
            defects.push_back("slot " + std::to_string(i) + " and wall " + all_walls[w].name +
                              " are within reach and not listed");
          }
        }
      }
    }
  }

  void list_walls(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                  const std::vector<Wall<Dim>>& all_walls, double dt) {
    found_walls_.clear();
    listed_walls_ = all_walls;
    wall_margin_.resize(all_walls.size());
    const double slack = size_ > 0 ? floor_ * radius.minCoeff() : 0;
    for (std::size_t w = 0; w < all_walls.size(); ++w) {
      const Wall<Dim>& wall = all_walls[w];
      // A fixed wall moves against the drift; without a drift it needs no margin.
      const bool still = !wall.moves() && drift_.isZero(0);
      wall_margin_[w] = still ? 0 : std::max(slack, kHorizon * dt * wall.fastest(drift_));
      const double reach = wall_reach(w);
      wall.for_each_within(
          x, [&](int i) { return radius[i] + margin_[i] + reach; },
          [&](int i, int piece) {
            if (rules_.may_touch(i, wall)) found_walls_.push_back({i, static_cast<int>(w), piece});
          });
    }
    std::sort(found_walls_.begin(), found_walls_.end());
    auto pair = found_walls_.cbegin();
    for (Block& block : blocks_) {
      block_walls_.clear();
      for (; pair != found_walls_.cend() && pair->i < block.end_slot; ++pair) {
        block_walls_.push_back(*pair);
      }
      block.walls.replace(block_walls_);
    }
  }

  /// @returns whether the pair was not listed
  template <class P>
  bool insert(PairTable<P, Memory>& table, const P& pair) {
    if (!table.insert(pair)) return false;
    paid_ += static_cast<std::int64_t>(table.size() / 2);
    return true;
  }

  int size_ = 0;  // number of grains
  int block_size_ = 1;
  std::vector<Block> blocks_;
  std::size_t across_ = 0;  // pairs across blocks
  bool listed_ = false;
  ContactRules rules_;                 // by slot
  double time_ = 0;                    // of the last refresh [s]
  Vec<Dim> drift_ = Vec<Dim>::Zero();  // velocity of the frame [m/s]
  Eigen::VectorXd margin_;             // of each grain, around its centre [m]
  std::vector<Stay> stay_;
  std::vector<Wall<Dim>> listed_walls_;  // as they were at the last refresh
  std::vector<double> wall_margin_;      // of each wall, around where it was then [m]
  std::vector<int> near_pieces_;         // scratch
  std::int64_t paid_ = 0;  // for amendments since the last refresh, in the unit of the prices
  std::int64_t amended_ = 0;
  std::int64_t slow_ = 0;    // grains that left margins set by the floor since the last refresh
  std::vector<Pair> found_;  // by the neighbourhood, in its last answer
  std::vector<Pair> found_within_, found_across_;  // of these, for one block
  std::vector<WallPair> found_walls_, block_walls_;
  double floor_ = 0.01;  // margin of slow grains, of their radii
  std::int64_t last_refresh_ = 0;
  std::int64_t refreshes_ = 0;
};

}  // namespace lagrain
