// Overlap queries of coal in a loop: coal_pairs PAIRS.txt COLD_ROUNDS WARM_ROUNDS; see coal_pairs.py.
#include <coal/collision.h>
#include <coal/shape/convex.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <memory>
#include <vector>

using namespace coal;
using Hull = Convex<Triangle>;

static double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

static std::shared_ptr<Hull> read_hull(std::istream& in) {
  size_t n, m;
  in >> n >> m;
  auto points = std::make_shared<std::vector<Vec3s>>(n);
  for (auto& p : *points) in >> p[0] >> p[1] >> p[2];
  auto faces = std::make_shared<std::vector<Triangle>>();
  for (size_t k = 0; k < m; ++k) {
    size_t a, b, c;
    in >> a >> b >> c;
    faces->push_back(Triangle(a, b, c));
  }
  return std::make_shared<Hull>(points, unsigned(n), faces, unsigned(m));
}

static Transform3s read_pose(std::istream& in) {
  double w, x, y, z;
  Vec3s t;
  in >> w >> x >> y >> z >> t[0] >> t[1] >> t[2];
  return Transform3s(Eigen::Quaterniond(w, x, y, z).toRotationMatrix(), t);
}

int main(int, char** argv) {
  std::ifstream in(argv[1]);
  size_t n;
  in >> n;
  std::vector<std::shared_ptr<Hull>> hulls;
  std::vector<Transform3s> poses;  // pair, pose, side
  for (size_t k = 0; k < 2 * n; ++k) hulls.push_back(read_hull(in));
  for (size_t k = 0; k < 4 * n; ++k) poses.push_back(read_pose(in));
  std::vector<ComputeCollision> queries;
  for (size_t k = 0; k < n; ++k) queries.emplace_back(hulls[2 * k].get(), hulls[2 * k + 1].get());
  std::cout << std::setprecision(17);
  for (bool cached : {false, true}) {
    const size_t rounds = std::stoul(argv[cached ? 3 : 2]);
    std::vector<CollisionRequest> requests(n, CollisionRequest(CONTACT, 1));
    if (cached)
      for (auto& request : requests) request.gjk_initial_guess = GJKInitialGuess::CachedGuess;
    std::vector<double> depth(n);
    double least = 1e300;
    for (int repeat = 0; repeat < 6; ++repeat) {  // the first finds the guesses
      const double began = cpu_seconds();
      for (size_t turn = 0; turn < 2 * rounds; ++turn)
        for (size_t k = 0; k < n; ++k) {
          CollisionResult result;
          queries[k](poses[4 * k + 2 * (turn % 2)], poses[4 * k + 2 * (turn % 2) + 1], requests[k], result);
          if (cached) requests[k].updateGuess(result);
          depth[k] = result.isCollision() ? -result.getContact(0).penetration_depth : 0.0;
        }
      if (repeat > 0) least = std::min(least, cpu_seconds() - began);
    }
    std::cout << least / double(2 * rounds * n) * 1e6;
    for (double d : depth) std::cout << ' ' << d;
    std::cout << '\n';
  }
}
