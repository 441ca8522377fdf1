// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/compiled_kernels.hpp>

namespace lagrain {

#define LAGRAIN_KERNEL(word, Normal, Friction)       \
  template class ContactKernel<2, Friction<Normal>>; \
  template class ContactKernel<3, Friction<Normal>>;
LAGRAIN_NORMAL_LAWS(LAGRAIN_KERNEL, RollingFriction)
#undef LAGRAIN_KERNEL

}  // namespace lagrain
