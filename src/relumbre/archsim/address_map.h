/// A hash table from addresses to small values.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace relumbre {

/// Open addressing with linear probing, at most half full; erasing moves what follows back, so that
/// there are no tombstones. O(1) an operation, on average. References hold until the next insert()
/// or erase().
template <class Value>
class AddressMap {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Null if it is not there.
  [[nodiscard]] Value* find(std::uint64_t address) {
    const std::size_t at = place_of(address);
    return slots_[at].used ? &slots_[at].value : nullptr;
  }

  /// What is there already, or `value` put there; and whether it was put.
  std::pair<Value&, bool> insert(std::uint64_t address, const Value& value) {
    std::size_t at = place_of(address);
    if (slots_[at].used) return {slots_[at].value, false};
    if (2 * (size_ + 1) > slots_.size()) {
      grow();
      at = place_of(address);
    }
    slots_[at] = {address, value, true};
    ++size_;
    return {slots_[at].value, true};
  }

  /// Does nothing if it is not there.
  void erase(std::uint64_t address) {
    std::size_t hole = place_of(address);
    if (!slots_[hole].used) return;
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t at = (hole + 1) & mask; slots_[at].used; at = (at + 1) & mask) {
      // It may move back if its home is not after the hole, on the ring.
      if (((at - home_of(slots_[at].address)) & mask) < ((at - hole) & mask)) continue;
      slots_[hole] = slots_[at];
      hole = at;
    }
    slots_[hole].used = false;
    --size_;
  }

 private:
  struct Slot {
    std::uint64_t address = 0;
    Value value{};
    bool used = false;
  };

  /// The high bits of a product with 2^64 / golden ratio. Source: Knuth, vol. 3, §6.4.
  [[nodiscard]] std::size_t home_of(std::uint64_t address) const {
    return static_cast<std::size_t>(address * 0x9E37'79B9'7F4A'7C15ULL >>
                                    (64 - std::countr_zero(slots_.size())));
  }

  /// Where it is, or would be put.
  [[nodiscard]] std::size_t place_of(std::uint64_t address) const {
    std::size_t at = home_of(address);
    while (slots_[at].used && slots_[at].address != address) at = (at + 1) & (slots_.size() - 1);
    return at;
  }

  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.used) slots_[place_of(slot.address)] = slot;
  }

  std::vector<Slot> slots_ = std::vector<Slot>(16);  // a power of two
  std::size_t size_ = 0;
};

}  // namespace relumbre
