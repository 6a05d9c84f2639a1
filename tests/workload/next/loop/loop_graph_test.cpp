// The pose graph of four degrees of freedom against closed formulas and against Eigen.
#include <gtest/gtest.h>

#include <array>

#include "tests/support/dense_algebra.h"
#include "tests/workload/math/math_fixture.h"
#include "workload/next/loop/loop_graph.h"

namespace leviosim::vio::test {
namespace {

using Native = work::Native;
using Counting = work::Counting;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct Place {
  Vector3d odometry;
  Vector3d node;
  double yaw;
  double travelled;
};
struct Loop {
  int from, to;
  Vector3d between;
  double yaw, path;
};
struct Graph {
  std::vector<Place> places;
  std::vector<Loop> loops;
};

/// A path that turns, whose nodes are where the odometry has them.
Graph random_graph(Random& random, int places, int loops) {
  Graph graph;
  Vector3d p(0, 0, 0);
  double travelled = 0;
  for (int i = 0; i < places; ++i) {
    const double turn = 0.15 * i;
    const Vector3d step(std::cos(turn), std::sin(turn), random.uniform(-0.2, 0.2));
    if (i > 0) {
      p += step;
      travelled += step.norm();
    }
    graph.places.push_back({p, p, 0, travelled});
  }
  for (int k = 0; k < loops; ++k) {
    const int from = random.below(places / 2), to = places - 1 - random.below(places / 3);
    const Vector3d noise(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3),
                         random.uniform(-0.3, 0.3));
    graph.loops.push_back(
        {from, to,
         graph.places[std::size_t(to)].odometry - graph.places[std::size_t(from)].odometry + noise,
         random.uniform(-0.08, 0.08), random.uniform(0, 2)});
  }
  return graph;
}

template <class P>
PlaceList<P> to_list(const Graph& graph, work::Arena& arena) {
  using F = typename P::F32;
  const auto number = [](double x) { return F(static_cast<float>(x)); };
  PlaceList<P> list(arena, {}, {});
  list.count = static_cast<int>(graph.places.size());
  for (int i = 0; i < list.count; ++i) {
    const Place& p = graph.places[std::size_t(i)];
    list.set_odometry(i, {Mat3<P>::identity(),
                          {number(p.odometry[0]), number(p.odometry[1]), number(p.odometry[2])}});
    list.set_node(i, {number(p.yaw), {number(p.node[0]), number(p.node[1]), number(p.node[2])}});
    list.travelled[i] = number(p.travelled);
    list.slots[i] = 0;
    list.features[i] = 0;
  }
  for (const Loop& loop : graph.loops)
    list.set_closure(list.closure_count++,
                     {loop.from,
                      loop.to,
                      {number(loop.between[0]), number(loop.between[1]), number(loop.between[2])},
                      number(loop.yaw),
                      number(loop.path)});
  return list;
}

Vector3d node_of(const PlaceList<Native>& list, int i) {
  const YawTransform<Native> node = list.node(i);
  return {double(node.t.x), double(node.t.y), double(node.t.z)};
}

/// One step by the normal equations, formed in double precision by differences of the residuals.
void reference_step(Graph& graph, const LoopGraphOptions& options) {
  const int n = static_cast<int>(graph.places.size());
  std::vector<Loop> edges;
  for (int i = 0; i + 1 < n; ++i)
    edges.push_back(
        {i, i + 1,
         graph.places[std::size_t(i + 1)].odometry - graph.places[std::size_t(i)].odometry, 0,
         std::max(0.1, graph.places[std::size_t(i + 1)].travelled -
                           graph.places[std::size_t(i)].travelled)});
  edges.insert(edges.end(), graph.loops.begin(), graph.loops.end());
  const auto residuals = [&](const std::vector<Place>& places) {
    VectorXd r(4 * edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const Loop& edge = edges[e];
      const Place &from = places[std::size_t(edge.from)], &to = places[std::size_t(edge.to)];
      const Vector3d expected = Eigen::AngleAxisd(from.yaw, Vector3d::UnitZ()) * edge.between;
      const bool closes = e >= edges.size() - graph.loops.size();
      const auto sigma = [&](float drift, float loop) {
        return std::sqrt(double(drift) * double(drift) * edge.path +
                         (closes ? double(loop) * double(loop) : 0));
      };
      const Eigen::Index at = static_cast<Eigen::Index>(4 * e);
      r.segment<3>(at) =
          (to.node - from.node - expected) / sigma(options.drift_position, options.loop_position);
      r[at + 3] = (to.yaw - from.yaw - edge.yaw) / sigma(options.drift_yaw, options.loop_yaw);
    }
    return r;
  };
  const VectorXd r = residuals(graph.places);
  MatrixXd J(r.size(), 4 * (n - 1));
  for (int c = 0; c < J.cols(); ++c) {
    constexpr double kStep = 1e-6;
    const auto moved = [&](double step) {
      std::vector<Place> places = graph.places;
      Place& place = places[std::size_t(1 + c / 4)];
      (c % 4 < 3 ? place.node[c % 4] : place.yaw) += step;
      return residuals(places);
    };
    J.col(c) = (moved(kStep) - moved(-kStep)) / (2 * kStep);
  }
  const VectorXd step = tests::least_squares(J, -r);
  for (int i = 1; i < n; ++i) {
    graph.places[std::size_t(i)].node += step.segment<3>(4 * (i - 1));
    graph.places[std::size_t(i)].yaw += step[4 * (i - 1) + 3];
  }
}

TEST(LoopGraph, StaysWhereItIsWithoutClosures) {
  Random random(1);
  const Graph graph = random_graph(random, 30, 0);
  work::Arena memory("L1", Bytes(1 << 18));
  PlaceList<Native> list = to_list<Native>(graph, memory);
  EXPECT_EQ(improve_nodes(memory, list, {}), 0.0f);
  for (int i = 0; i < list.count; ++i)
    EXPECT_LT((node_of(list, i) - graph.places[std::size_t(i)].node).norm(), 1e-6) << i;
}

/// Without doubt in the yaw, a closure's error is shared among the edges by their lengths; of n
/// edges in a row of information w each and a closure of information v, each takes 1 / (n + w / v).
TEST(LoopGraph, SharesTheErrorOfAClosureByThePath) {
  LoopGraphOptions options;
  options.drift_yaw = options.loop_yaw = 1e-5f;
  options.drift_position = 0.1f;
  options.loop_position = 0.1f;
  Graph graph;
  constexpr int kEdges = 9;
  for (int i = 0; i <= kEdges; ++i)
    graph.places.push_back({Vector3d(i, 0, 0), Vector3d(i, 0, 0), 0, double(i)});
  graph.loops.push_back({0, kEdges, Vector3d(kEdges - 1.0, 0, 0.5), 0, 0});
  work::Arena memory("L1", Bytes(1 << 18));
  PlaceList<Native> list = to_list<Native>(graph, memory);
  for (int step = 0; step < 3; ++step) improve_nodes(memory, list, options);
  const double share = 1.0 / (kEdges + 1);
  for (int i = 0; i <= kEdges; ++i) {
    EXPECT_NEAR(node_of(list, i).x(), i - share * i, 2e-4) << i;
    EXPECT_NEAR(node_of(list, i).z(), 0.5 * share * i, 2e-4) << i;
  }
}

TEST(LoopGraph, StepsAsTheNormalEquationsSay) {
  Random random(5);
  LoopGraphOptions options;
  options.iterations = 200;
  for (int trial = 0; trial < 10; ++trial) {
    Graph graph = random_graph(random, 12 + 10 * trial, 1 + trial);
    work::Arena memory("L1", Bytes(1 << 18));
    PlaceList<Native> list = to_list<Native>(graph, memory);
    for (int step = 0; step < 3; ++step) {
      improve_nodes(memory, list, options);
      reference_step(graph, options);
      double largest = 0;
      for (const Place& p : graph.places) largest = std::max(largest, (p.node - p.odometry).norm());
      for (int i = 0; i < list.count; ++i) {
        const Place& p = graph.places[std::size_t(i)];
        EXPECT_LT((node_of(list, i) - p.node).norm(), 0.005 * largest + 1e-4)
            << trial << " " << step << " " << i;
        EXPECT_NEAR(double(list.node(i).yaw), p.yaw, 5e-4) << trial << " " << step << " " << i;
      }
    }
  }
}

TEST(LoopGraph, ComesNearTheSolutionWithinItsIterations) {
  Random random(9);
  const Graph start = random_graph(random, 120, 32);
  Graph graph = start;
  work::Arena memory("L1", Bytes(1 << 18));
  PlaceList<Native> list = to_list<Native>(start, memory);
  const LoopGraphOptions options;
  for (int step = 0; step < options.steps; ++step) {
    improve_nodes(memory, list, options);
    reference_step(graph, options);
  }
  for (int i = 0; i < list.count; ++i)
    EXPECT_LT((node_of(list, i) - graph.places[std::size_t(i)].node).norm(), 0.02) << i;
}

TEST(LoopGraph, IsTheSameUnderBothPolicies) {
  Random random(3);
  const Graph graph = random_graph(random, 40, 5);
  work::Arena plain("L1", Bytes(1 << 18)), counted("L1", Bytes(1 << 18));
  PlaceList<Native> native = to_list<Native>(graph, plain);
  PlaceList<Counting> counting = to_list<Counting>(graph, counted);
  for (int step = 0; step < 2; ++step)
    EXPECT_EQ(improve_nodes(plain, native, {}), work::value(improve_nodes(counted, counting, {})));
  for (int i = 0; i < 4 * native.count; ++i) EXPECT_EQ(native.nodes[i], counting.nodes.data()[i].v);
}

}  // namespace
}  // namespace leviosim::vio::test
