/// Control points of the Utah teapot, Martin Newell 1975, with the bottom that Frank Crow added.
/// z up, in the original's units: 3.15 high, the body of radius 2 about the z axis.
///
/// Of the 32 bicubic patches ten are stored; the others are their images. Points are row-major,
/// s down the rows, t along them, and dP/dt × dP/ds points outward.
#pragma once

#include <array>

#include "relumbre/base/vec3.h"

namespace relumbre {

using BezierPatch = std::array<Vec3f, 16>;

/// Quarters of a surface of revolution, from the rim to the middle of the bottom. The other three
/// are turned by -90, -180 and -270 degrees about z.
inline constexpr std::array<BezierPatch, 4> kTeapotBody{{
    // rim
    {{{1.4F, 0.0F, 2.4F},
      {1.4F, -0.784F, 2.4F},
      {0.784F, -1.4F, 2.4F},
      {0.0F, -1.4F, 2.4F},
      {1.3375F, 0.0F, 2.53125F},
      {1.3375F, -0.749F, 2.53125F},
      {0.749F, -1.3375F, 2.53125F},
      {0.0F, -1.3375F, 2.53125F},
      {1.4375F, 0.0F, 2.53125F},
      {1.4375F, -0.805F, 2.53125F},
      {0.805F, -1.4375F, 2.53125F},
      {0.0F, -1.4375F, 2.53125F},
      {1.5F, 0.0F, 2.4F},
      {1.5F, -0.84F, 2.4F},
      {0.84F, -1.5F, 2.4F},
      {0.0F, -1.5F, 2.4F}}},
    // upper body
    {{{1.5F, 0.0F, 2.4F},
      {1.5F, -0.84F, 2.4F},
      {0.84F, -1.5F, 2.4F},
      {0.0F, -1.5F, 2.4F},
      {1.75F, 0.0F, 1.875F},
      {1.75F, -0.98F, 1.875F},
      {0.98F, -1.75F, 1.875F},
      {0.0F, -1.75F, 1.875F},
      {2.0F, 0.0F, 1.35F},
      {2.0F, -1.12F, 1.35F},
      {1.12F, -2.0F, 1.35F},
      {0.0F, -2.0F, 1.35F},
      {2.0F, 0.0F, 0.9F},
      {2.0F, -1.12F, 0.9F},
      {1.12F, -2.0F, 0.9F},
      {0.0F, -2.0F, 0.9F}}},
    // lower body
    {{{2.0F, 0.0F, 0.9F},
      {2.0F, -1.12F, 0.9F},
      {1.12F, -2.0F, 0.9F},
      {0.0F, -2.0F, 0.9F},
      {2.0F, 0.0F, 0.45F},
      {2.0F, -1.12F, 0.45F},
      {1.12F, -2.0F, 0.45F},
      {0.0F, -2.0F, 0.45F},
      {1.5F, 0.0F, 0.225F},
      {1.5F, -0.84F, 0.225F},
      {0.84F, -1.5F, 0.225F},
      {0.0F, -1.5F, 0.225F},
      {1.5F, 0.0F, 0.15F},
      {1.5F, -0.84F, 0.15F},
      {0.84F, -1.5F, 0.15F},
      {0.0F, -1.5F, 0.15F}}},
    // bottom
    {{{1.5F, 0.0F, 0.15F},
      {1.5F, -0.84F, 0.15F},
      {0.84F, -1.5F, 0.15F},
      {0.0F, -1.5F, 0.15F},
      {1.5F, 0.0F, 0.075F},
      {1.5F, -0.84F, 0.075F},
      {0.84F, -1.5F, 0.075F},
      {0.0F, -1.5F, 0.075F},
      {1.425F, 0.0F, 0.0F},
      {1.425F, -0.798F, 0.0F},
      {0.798F, -1.425F, 0.0F},
      {0.0F, -1.425F, 0.0F},
      {0.0F, 0.0F, 0.0F},
      {0.0F, 0.0F, 0.0F},
      {0.0F, 0.0F, 0.0F},
      {0.0F, 0.0F, 0.0F}}},
}};

/// Quarters likewise, from the knob's top to the lid's edge.
inline constexpr std::array<BezierPatch, 2> kTeapotLid{{
    // knob
    {{{0.0F, 0.0F, 3.15F},
      {0.0F, 0.0F, 3.15F},
      {0.0F, 0.0F, 3.15F},
      {0.0F, 0.0F, 3.15F},
      {0.8F, 0.0F, 3.15F},
      {0.8F, -0.45F, 3.15F},
      {0.45F, -0.8F, 3.15F},
      {0.0F, -0.8F, 3.15F},
      {0.0F, 0.0F, 2.85F},
      {0.0F, 0.0F, 2.85F},
      {0.0F, 0.0F, 2.85F},
      {0.0F, 0.0F, 2.85F},
      {0.2F, 0.0F, 2.7F},
      {0.2F, -0.112F, 2.7F},
      {0.112F, -0.2F, 2.7F},
      {0.0F, -0.2F, 2.7F}}},
    // lid
    {{{0.2F, 0.0F, 2.7F},
      {0.2F, -0.112F, 2.7F},
      {0.112F, -0.2F, 2.7F},
      {0.0F, -0.2F, 2.7F},
      {0.4F, 0.0F, 2.55F},
      {0.4F, -0.224F, 2.55F},
      {0.224F, -0.4F, 2.55F},
      {0.0F, -0.4F, 2.55F},
      {1.3F, 0.0F, 2.55F},
      {1.3F, -0.728F, 2.55F},
      {0.728F, -1.3F, 2.55F},
      {0.0F, -1.3F, 2.55F},
      {1.3F, 0.0F, 2.4F},
      {1.3F, -0.728F, 2.4F},
      {0.728F, -1.3F, 2.4F},
      {0.0F, -1.3F, 2.4F}}},
}};

/// Halves with y <= 0, from the end at the rim to the end at the body; the others are mirrored in
/// y.
inline constexpr std::array<BezierPatch, 2> kTeapotHandle{{
    // upper handle
    {{{-1.6F, 0.0F, 2.025F},
      {-1.6F, -0.3F, 2.025F},
      {-1.5F, -0.3F, 2.25F},
      {-1.5F, 0.0F, 2.25F},
      {-2.3F, 0.0F, 2.025F},
      {-2.3F, -0.3F, 2.025F},
      {-2.5F, -0.3F, 2.25F},
      {-2.5F, 0.0F, 2.25F},
      {-2.7F, 0.0F, 2.025F},
      {-2.7F, -0.3F, 2.025F},
      {-3.0F, -0.3F, 2.25F},
      {-3.0F, 0.0F, 2.25F},
      {-2.7F, 0.0F, 1.8F},
      {-2.7F, -0.3F, 1.8F},
      {-3.0F, -0.3F, 1.8F},
      {-3.0F, 0.0F, 1.8F}}},
    // lower handle
    {{{-2.7F, 0.0F, 1.8F},
      {-2.7F, -0.3F, 1.8F},
      {-3.0F, -0.3F, 1.8F},
      {-3.0F, 0.0F, 1.8F},
      {-2.7F, 0.0F, 1.575F},
      {-2.7F, -0.3F, 1.575F},
      {-3.0F, -0.3F, 1.35F},
      {-3.0F, 0.0F, 1.35F},
      {-2.5F, 0.0F, 1.125F},
      {-2.5F, -0.3F, 1.125F},
      {-2.65F, -0.3F, 0.9375F},
      {-2.65F, 0.0F, 0.9375F},
      {-2.0F, 0.0F, 0.9F},
      {-2.0F, -0.3F, 0.9F},
      {-1.9F, -0.3F, 0.6F},
      {-1.9F, 0.0F, 0.6F}}},
}};

/// Halves likewise, from the body to the mouth.
inline constexpr std::array<BezierPatch, 2> kTeapotSpout{{
    // lower spout
    {{{1.7F, 0.0F, 1.425F},
      {1.7F, -0.66F, 1.425F},
      {1.7F, -0.66F, 0.6F},
      {1.7F, 0.0F, 0.6F},
      {2.6F, 0.0F, 1.425F},
      {2.6F, -0.66F, 1.425F},
      {3.1F, -0.66F, 0.825F},
      {3.1F, 0.0F, 0.825F},
      {2.3F, 0.0F, 2.1F},
      {2.3F, -0.25F, 2.1F},
      {2.4F, -0.25F, 2.025F},
      {2.4F, 0.0F, 2.025F},
      {2.7F, 0.0F, 2.4F},
      {2.7F, -0.25F, 2.4F},
      {3.3F, -0.25F, 2.4F},
      {3.3F, 0.0F, 2.4F}}},
    // upper spout
    {{{2.7F, 0.0F, 2.4F},
      {2.7F, -0.25F, 2.4F},
      {3.3F, -0.25F, 2.4F},
      {3.3F, 0.0F, 2.4F},
      {2.8F, 0.0F, 2.475F},
      {2.8F, -0.25F, 2.475F},
      {3.525F, -0.25F, 2.49375F},
      {3.525F, 0.0F, 2.49375F},
      {2.9F, 0.0F, 2.475F},
      {2.9F, -0.15F, 2.475F},
      {3.45F, -0.15F, 2.5125F},
      {3.45F, 0.0F, 2.5125F},
      {2.8F, 0.0F, 2.4F},
      {2.8F, -0.15F, 2.4F},
      {3.2F, -0.15F, 2.4F},
      {3.2F, 0.0F, 2.4F}}},
}};

}  // namespace relumbre
