#include "relumbre/cuda/memory.h"
#include "relumbre/sat/sat_table_cuda.h"
#include "relumbre/sat/sat_tiles_cuda.cuh"

namespace relumbre::cuda {

template <class In, class T>
void build_sat_table(const In* pixels, const SatLayout& layout, const SatSummands<In>& summands,
                     T* table, unsigned long long* first_outside, ScanScratch& scratch,
                     const Stream& stream) {
  if (layout.pixels() == 0) return clear(table, layout.elements, stream);
  const sat_detail::Build<In, T> build{pixels, layout, summands, table, {}, false, first_outside};
  switch (layout.channels) {
    case 1:
      return sat_detail::build_table<In, T, 1>(build, scratch, stream);
    case 2:
      return sat_detail::build_table<In, T, 2>(build, scratch, stream);
    case 3:
      return sat_detail::build_table<In, T, 3>(build, scratch, stream);
    default:
      return sat_detail::build_table<In, T, 4>(build, scratch, stream);
  }
}

#define RELUMBRE_INSTANTIATE_ONE(In, T)                                                  \
  template void build_sat_table(const In*, const SatLayout&, const SatSummands<In>&, T*, \
                                unsigned long long*, ScanScratch&, const Stream&);
#define RELUMBRE_INSTANTIATE(In)              \
  RELUMBRE_INSTANTIATE_ONE(In, std::uint32_t) \
  RELUMBRE_INSTANTIATE_ONE(In, std::uint64_t) \
  RELUMBRE_INSTANTIATE_ONE(In, float)         \
  RELUMBRE_INSTANTIATE_ONE(In, double)
RELUMBRE_INSTANTIATE(float)
RELUMBRE_INSTANTIATE(std::uint8_t)
RELUMBRE_INSTANTIATE(std::uint16_t)
RELUMBRE_INSTANTIATE(std::uint32_t)
#undef RELUMBRE_INSTANTIATE
#undef RELUMBRE_INSTANTIATE_ONE

}  // namespace relumbre::cuda
