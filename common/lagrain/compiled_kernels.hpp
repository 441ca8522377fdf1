#pragma once
/// @file
/// The contact kernels that the library holds compiled. A program that steps one of these laws is
/// compiled much faster if it includes this header; results are the same without.

#include <lagrain/contact_kernel.hpp>
#include <lagrain/cundall_strack.hpp>
#include <lagrain/hertz.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/viscous_friction.hpp>

namespace lagrain {

extern template class ContactKernel<2, LinearSpring>;
extern template class ContactKernel<2, Hertz>;
extern template class ContactKernel<2, ViscousFriction<LinearSpring>>;
extern template class ContactKernel<2, ViscousFriction<Hertz>>;
extern template class ContactKernel<2, CundallStrack<LinearSpring>>;
extern template class ContactKernel<2, CundallStrack<Hertz>>;
extern template class ContactKernel<3, LinearSpring>;
extern template class ContactKernel<3, Hertz>;
extern template class ContactKernel<3, ViscousFriction<LinearSpring>>;
extern template class ContactKernel<3, ViscousFriction<Hertz>>;
extern template class ContactKernel<3, CundallStrack<LinearSpring>>;
extern template class ContactKernel<3, CundallStrack<Hertz>>;

}  // namespace lagrain
