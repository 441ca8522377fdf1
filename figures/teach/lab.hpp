// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Those functions of lab.cpp that C++ calls as well. What stands in a text or a picture comes from
/// the same code as what moves in the page. (JavaScript needs no header; lab.cpp explains them.)

extern "C" {
const char* lagrain_error();
const double* lagrain_reals();
int lagrain_real_count();
const int* lagrain_ints();
int lagrain_int_count();
int sign_map(int n, double px, double py, double qx, double qy, double rx, double ry);
int grains_leap(int on);
int grains_start(int kind, int n, int seed, double friction, double restitution);
int grains_step(int count);
double grains_time();
double grains_time_step();
int grains_places();
int grains_contacts();
int grains_walls();
int grains_triangulation();
int grains_report();
int grains_hash();
int impact(int integrator, double steps_per_contact, double restitution);
int impact_integrators();
const char* impact_integrator_name(int integrator);
}
