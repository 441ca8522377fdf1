// SPDX-License-Identifier: GPL-3.0-or-later
#include "lammps.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>

#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>

namespace lagrain::bench {

namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

void append(std::string& line, double number) {
  line += ' ';
  line += shortest(number);
}

double median_mass(std::vector<double> masses) {
  const auto middle = masses.begin() + static_cast<std::ptrdiff_t>(masses.size() / 2);
  std::nth_element(masses.begin(), middle, masses.end());
  return *middle;
}

template <int Dim>
std::vector<double> masses_of(const Bed<Dim>& bed) {
  std::vector<double> masses;
  for (const Grain<Dim>& grain : bed.grains) masses.push_back(grain.mass);
  return masses;
}

/// kn kt gamma_n gamma_t mu 1, as the pair style and the walls want them.
std::string coefficients(const Law& law, double effective_mass) {
  const double kn = law.normal.stiffness, kt = law.stiffness_ratio * kn;
  const double gamma_n = 2 * law.normal.damping_ratio * std::sqrt(kn / effective_mass);
  const double gamma_t = 2 * law.tangential_damping_ratio * std::sqrt(kt / effective_mass);
  return shortest(kn) + " " + shortest(kt) + " " + shortest(gamma_n) + " " + shortest(gamma_t) +
         " " + shortest(law.friction) + " 1";
}

/// Where the only wall of its direction stands at time 0, and NULL if there is none.
template <int Dim>
std::string wall_at(const Bed<Dim>& bed, int axis, double sign) {
  for (Wall<Dim> wall : bed.walls) {
    const auto* plane = std::get_if<HalfSpace<Dim>>(&wall.shape);
    LAGRAIN_EXPECTS(plane != nullptr, "wall " + wall.name + " is no half-space");
    if (sign * plane->normal[axis] < 0.99) continue;
    wall.advance(0, 0);
    return shortest(wall.point[axis]);
  }
  return "NULL";
}

template <int Dim>
std::string wiggle(const Bed<Dim>& bed) {
  if (bed.walls.empty()) return "";
  const auto* motion = std::get_if<Shake<Dim>>(&bed.walls.front().motion);
  if (motion == nullptr) return "";
  return std::string(" wiggle ") + kAxes[Dim - 1] + " " + shortest(motion->amplitude.norm()) + " " +
         shortest(1 / motion->frequency);
}

constexpr const char* kLoopTime = "Loop time of ";

/// The first number after `label` in `text`, searched from the end.
double number_after(const std::string& text, const std::string& label) {
  const std::size_t at = text.rfind(label);
  if (at == std::string::npos) throw SimulationError("LAMMPS does not report \"" + label + "\"");
  return std::strtod(text.c_str() + at + label.size(), nullptr);
}

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// What LAMMPS logs of one run: "Loop time of 1.2 on 1 procs ...", "98.7% CPU use with ...", and a
/// table "Pair | min | avg | max | ...".
struct LoopTimes {
  double wall = 0;  // [s]
  double cpu = 0;   // [s]
  std::vector<std::pair<std::string, double>> phases;
};

/// @param log from "Loop time of" on
LoopTimes loop_times(const std::string& log) {
  LoopTimes times;
  times.wall = number_after(log, kLoopTime);
  const std::size_t use = log.find("% CPU use");
  const std::size_t line = use == std::string::npos ? use : log.rfind('\n', use);
  const double share = line == std::string::npos ? 100 : std::strtod(&log[line + 1], nullptr);
  times.cpu = times.wall * share / 100;
  const std::size_t table = log.find("MPI task timing breakdown");
  if (table == std::string::npos) return times;
  std::istringstream lines(log.substr(table));
  std::string text;
  for (int heading = 0; heading < 3; ++heading) std::getline(lines, text);
  while (std::getline(lines, text) && text.find('|') != std::string::npos) {
    std::istringstream fields(text);
    std::string name, number;
    std::getline(fields, name, '|');
    std::getline(fields, number, '|');
    std::getline(fields, number, '|');
    name.erase(name.find_last_not_of(' ') + 1);
    times.phases.emplace_back(name, std::strtod(number.c_str(), nullptr));
  }
  return times;
}

template <int Dim>
void read_dump(const fs::path& file, int count, LammpsReport<Dim>& report) {
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line) && !line.starts_with("ITEM: ATOMS")) {
  }
  report.position.setConstant(Dim, count, std::numeric_limits<double>::quiet_NaN());
  report.velocity = report.position;
  int found = 0;
  for (; std::getline(in, line); ++found) {
    std::istringstream fields(line);
    int id = 0;
    std::array<double, 6> v{};
    fields >> id;
    for (double& value : v) fields >> value;
    if (id < 1 || id > count) throw SimulationError("LAMMPS leaves an atom " + std::to_string(id));
    for (std::size_t d = 0; d < Dim; ++d) {
      report.position(static_cast<Eigen::Index>(d), id - 1) = v[d];
      report.velocity(static_cast<Eigen::Index>(d), id - 1) = v[3 + d];
    }
  }
  if (found != count) {
    throw SimulationError("LAMMPS leaves " + std::to_string(found) + " of " +
                          std::to_string(count) + " atoms");
  }
}

}  // namespace

std::optional<fs::path> find_lammps() {
  if (const char* named = std::getenv("LAGRAIN_LAMMPS")) {
    if (access(named, X_OK) == 0) return fs::absolute(named);
    return std::nullopt;
  }
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path program = fs::path(folder) / "lmp";
    if (access(program.c_str(), X_OK) == 0) return program;
  }
  return std::nullopt;
}

std::string lammps_version(const fs::path& program) {
  const std::string command = "'" + program.string() + "' -h 2>/dev/null";
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return "unknown";
  std::string text;
  std::array<char, 4096> part{};
  while (std::fgets(part.data(), part.size(), pipe) != nullptr) text += part.data();
  pclose(pipe);
  constexpr std::string_view kBefore = "Parallel Simulator - ";
  const std::size_t at = text.find(kBefore);
  if (at == std::string::npos) return "unknown";
  const std::size_t begin = at + kBefore.size();
  return text.substr(begin, text.find('\n', begin) - begin);
}

template <int Dim>
std::vector<int> lammps_types(const Bed<Dim>& bed) {
  std::vector<double> radii;
  for (const Grain<Dim>& grain : bed.grains) radii.push_back(grain.radius);
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  std::vector<int> types;
  for (const Grain<Dim>& grain : bed.grains) types.push_back(grain.radius > 2 * *middle ? 2 : 1);
  return types;
}

template <int Dim>
std::string lammps_data(const Bed<Dim>& bed) {
  const std::vector<int> types = lammps_types<Dim>(bed);
  // Room for what is thrown up: an atom that leaves the domain is lost.
  double top = 0, largest = 0;
  for (const Grain<Dim>& grain : bed.grains) {
    top = std::max(top, grain.position[Dim - 1] + grain.radius);
    largest = std::max(largest, grain.radius);
  }
  std::string text = "grains of a bed, written by lagrain\n\n" + std::to_string(bed.count()) +
                     " atoms\n" + std::to_string(*std::max_element(types.begin(), types.end())) +
                     " atom types\n\n";
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = kAxes[static_cast<std::size_t>(axis)];
    const bool flat = axis == 2 && Dim == 2;
    const double high = axis == Dim - 1 ? 2 * top + 1
                        : flat          ? 0.5
                                        : bed.size[std::min(axis, Dim - 1)];
    const double room = flat ? 0 : largest;
    text += shortest((flat ? -0.5 : 0) - room) + " " + shortest(high + room) + " " + name + "lo " +
            name + "hi\n";
  }
  text += "\nAtoms # sphere\n\n";
  for (std::size_t i = 0; i < bed.grains.size(); ++i) {
    const Grain<Dim>& grain = bed.grains[i];
    text += std::to_string(i + 1) + " " + std::to_string(types[i]) + " " +
            shortest(2 * grain.radius) + " " + shortest(grain.mass / grain_volume<3>(grain.radius));
    for (int axis = 0; axis < 3; ++axis) {
      append(text, axis < Dim ? grain.position[std::min(axis, Dim - 1)] : 0);
    }
    text += "\n";
  }
  text += "\nVelocities\n\n";
  for (std::size_t i = 0; i < bed.grains.size(); ++i) {
    const Grain<Dim>& grain = bed.grains[i];
    text += std::to_string(i + 1);
    for (int axis = 0; axis < 3; ++axis) {
      append(text, axis < Dim ? grain.velocity[std::min(axis, Dim - 1)] : 0);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int mine = Dim == 3 ? axis : axis == 2 ? 0 : -1;
      append(text, mine >= 0 ? grain.omega[mine] : 0);
    }
    text += "\n";
  }
  return text;
}

template <int Dim>
std::string lammps_input(const Bed<Dim>& bed, const LammpsPlan& plan) {
  const double mass = median_mass(masses_of(bed));
  double smallest = bed.grains.front().radius;
  for (const Grain<Dim>& grain : bed.grains) smallest = std::min(smallest, grain.radius);
  std::string text =
      "units si\ndimension " + std::to_string(Dim) + "\nboundary f f " + (Dim == 2 ? "p" : "f") +
      "\natom_style sphere\nnewton off\ncomm_modify vel yes\nread_data data.lammps\n";
  text += "neighbor " + shortest(kLammpsSkin * smallest) + (plan.multi ? " multi" : " bin") +
          "\nneigh_modify delay 0 every 1 check yes one 20000 page 400000\n";
  text += "pair_style gran/hooke/history " + coefficients(bed.law, mass / 2) +
          "\npair_coeff * *\ntimestep " + shortest(bed.setting.time_step) + "\n";
  text += std::string("fix motion all nve/sphere") + (Dim == 2 ? " disc" : "") + "\n";
  text += "fix gravity all gravity " + shortest(bed.setting.gravity.norm()) +
          (Dim == 2 ? " vector 0 -1 0\n" : " vector 0 0 -1\n");
  for (int axis = 0; axis < Dim; ++axis) {
    const std::string name = kAxes[static_cast<std::size_t>(axis)];
    const std::string low = wall_at<Dim>(bed, axis, 1), high = wall_at<Dim>(bed, axis, -1);
    if (low == "NULL" && high == "NULL") continue;
    text += "fix walls_" + name + " all wall/gran hooke/history " + coefficients(bed.law, mass) +
            " " + name + "plane " + low + " " + high + wiggle(bed) + "\n";
  }
  if (Dim == 2) text += "fix flat all enforce2d\n";
  text += "thermo_style custom step ke\nthermo 1000000\n";
  // Whoever takes turns with others has it paused, before the measured steps and between them.
  text += "variable pause index \"print ''\"\n";
  text += "run " + std::to_string(plan.warm_up) + "\n${pause}\n";
  text += "run " + std::to_string(plan.steps) + " pre no every " +
          std::to_string(plan.steps / plan.turns) + " \"${pause}\"\n";
  text +=
      std::string("write_dump all custom end.dump id x y z vx vy vz modify format float %.17g") +
      " sort id\n";
  return text;
}

template <int Dim>
LammpsRun<Dim>::LammpsRun(const fs::path& program, fs::path folder, const Bed<Dim>& bed,
                          const LammpsPlan& plan)
    : folder_(std::move(folder)), count_(bed.count()), turns_(plan.turns) {
  make_folder(folder_);
  write_file(folder_ / "data.lammps", lammps_data<Dim>(bed));
  write_file(folder_ / "in.lammps", lammps_input<Dim>(bed, plan));
  // Its input and output are one end of a line to us: in a pause it sends a byte, and waits for one
  // or for the end of the line, so that it does not outlive us waiting. (By the shell's own words:
  // a program that starts in the background would slow whoever is measured then.)
  std::array<int, 2> line{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, line.data()) != 0) {
    throw SimulationError("LAMMPS cannot be talked to");
  }
  line_.number = line[0];
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {0, 1}) posix_spawn_file_actions_adddup2(&actions, line[1], stream);
  const std::string command =
      "cd \"$1\" && OMP_NUM_THREADS=1 exec \"$0\" -in in.lammps -log log.lammps -screen none -var "
      "pause 'shell echo && read line' 2>/dev/null";
  std::vector<std::string> words{"sh", "-c", command, program.string(), folder_.string()};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  // Not forked: each page of ours would be slow to write once afterwards, and whoever takes turns
  // with LAMMPS would be measured doing so.
  const int error = posix_spawn(&process_, "/bin/sh", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(line[1]);
  if (error != 0) throw SimulationError("LAMMPS cannot be started");
  wait_for_pause();
}

template <int Dim>
LammpsRun<Dim>::Descriptor::~Descriptor() {
  if (number >= 0) close(number);
}

template <int Dim>
LammpsRun<Dim>::~LammpsRun() {
  if (process_ == 0) return;
  kill(process_, SIGKILL);
  wait_for_end();
}

template <int Dim>
void LammpsRun<Dim>::take_turn() {
  go_on();
  wait_for_pause();
}

template <int Dim>
void LammpsRun<Dim>::go_on() {
  // If it has ended, that is seen when it is waited for.
  send(line_.number, "\n", 1, MSG_NOSIGNAL);
}

/// Waits until the process has paused or ended.
/// @returns whether it has paused
template <int Dim>
bool LammpsRun<Dim>::pauses() {
  char byte = 0;
  ssize_t received = 0;
  while ((received = read(line_.number, &byte, 1)) < 0 && errno == EINTR) {
  }
  if (received > 0) return true;
  const int status = wait_for_end();
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (code == 0) return false;
  const std::string log = content(folder_ / "log.lammps");
  const std::size_t at = log.find("ERROR");
  throw SimulationError(
      "LAMMPS ended with code " + std::to_string(code) +
      (at == std::string::npos ? "" : ": " + log.substr(at, log.find('\n', at) - at)));
}

template <int Dim>
int LammpsRun<Dim>::wait_for_end() {
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = 0;
  return status;
}

template <int Dim>
void LammpsRun<Dim>::wait_for_pause() {
  if (!pauses()) throw SimulationError("LAMMPS ended too early");
}

template <int Dim>
LammpsReport<Dim> LammpsRun<Dim>::finish() {
  go_on();
  if (pauses()) throw SimulationError("LAMMPS does not end");
  const std::string log = content(folder_ / "log.lammps");
  LammpsReport<Dim> report;
  std::size_t end = std::string::npos;
  for (int turn = 0; turn < turns_; ++turn) {
    const std::size_t begin = log.rfind(kLoopTime, end - 1);
    if (begin == std::string::npos) throw SimulationError("LAMMPS has lost a turn");
    const LoopTimes times = loop_times(log.substr(begin, end - begin));
    report.wall_seconds += times.wall;
    report.cpu_seconds += times.cpu;
    for (const auto& [name, seconds] : times.phases) {
      const auto known = std::find_if(report.phases.begin(), report.phases.end(),
                                      [&, &n = name](const auto& p) { return p.first == n; });
      if (known == report.phases.end()) {
        report.phases.emplace_back(name, seconds);
      } else {
        known->second += seconds;
      }
    }
    end = begin;
  }
  report.neighbours = static_cast<std::int64_t>(number_after(log, "Total # of neighbors = "));
  // It counts these from its first step on.
  const std::string before = log.substr(0, end);
  const auto counted = [&](const char* label) {
    return static_cast<std::int64_t>(number_after(log, label) - number_after(before, label));
  };
  report.builds = counted("Neighbor list builds = ");
  report.dangerous = counted("Dangerous builds = ");
  read_dump<Dim>(folder_ / "end.dump", count_, report);
  fs::remove(folder_ / "end.dump");
  return report;
}

template std::vector<int> lammps_types<2>(const Bed<2>&);
template std::vector<int> lammps_types<3>(const Bed<3>&);
template std::string lammps_data<2>(const Bed<2>&);
template std::string lammps_data<3>(const Bed<3>&);
template std::string lammps_input<2>(const Bed<2>&, const LammpsPlan&);
template std::string lammps_input<3>(const Bed<3>&, const LammpsPlan&);
template class LammpsRun<2>;
template class LammpsRun<3>;

}  // namespace lagrain::bench
