#include "relumbre/archsim/tiles.h"

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

Tiles::Tiles(std::uint32_t width, std::uint32_t height, std::uint32_t tile, std::uint32_t units)
    : width_(width), height_(height), tile_(tile), units_(units) {
  if (width == 0 || height == 0)
    throw ValueError(fmt::format("a picture of {} x {} pixels has no tiles", width, height));
  if (tile == 0) throw ValueError("tiles of 0 pixels");
  if (units == 0 || units > kMaxUnits)
    throw ValueError(fmt::format("{} geometry units: there must be 1 to {}", units, kMaxUnits));
  columns_ = (std::uint64_t{width} + tile - 1) / tile;
  rows_ = (std::uint64_t{height} + tile - 1) / tile;
}

PixelRect Tiles::tile(std::uint64_t index) const {
  const std::uint64_t x = index % columns_ * tile_, y = index / columns_ * tile_;
  return {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
          static_cast<std::uint32_t>(std::min<std::uint64_t>(x + tile_, width_)),
          static_cast<std::uint32_t>(std::min<std::uint64_t>(y + tile_, height_))};
}

}  // namespace relumbre
