// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The contact kernels that the library holds compiled: those of all listed laws. A program
/// that steps one of them is compiled much faster if it includes this header; results are the
/// same without.

#include <lagrain/contact_kernel.hpp>
#include <lagrain/contact_laws.hpp>

namespace lagrain {

/// @cond
#define LAGRAIN_KERNEL(word, Normal, Friction)              \
  extern template class ContactKernel<2, Friction<Normal>>; \
  extern template class ContactKernel<3, Friction<Normal>>;
#define LAGRAIN_KERNELS(word, Friction) LAGRAIN_NORMAL_LAWS(LAGRAIN_KERNEL, Friction)
LAGRAIN_FRICTION_LAWS(LAGRAIN_KERNELS)
#undef LAGRAIN_KERNELS
#undef LAGRAIN_KERNEL
/// @endcond

}  // namespace lagrain
