/// The CIE standard overcast sky, for daylight without an image.
#pragma once

#include "relumbre/image/image.h"

namespace relumbre {

/// A latitude-longitude radiance image with zenith radiance 1: L(γ) = (1 + 2 sin γ) / 3 at altitude
/// γ, which puts 7π/9 on a horizontal surface; below the horizon a ground that reflects a fifth of
/// that. Source: Moon and Spencer 1942; ISO 15469:2004, sky type 16.
Image overcast_sky();

}  // namespace relumbre
