// Trees over places: every place is in the leaf that it was put into, and damaged ones are invalid.
#include "ext/guiding/point_tree.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "support/structure.h"

namespace pbrt::test {
using namespace ext;
namespace {

struct Built {
    PointTree tree;
    std::vector<std::vector<Point3>> leaves;
    bool isOrdered = true;  ///< what Divide puts first lies in the first child

    void Divide(size_t node, Point3 *begin, Point3 *end, std::ptrdiff_t most) {
        Point3 *second = begin;
        if (end - begin > most) second = tree.Divide(node, begin, end, [](const Point3 &p) { return p; });
        if (second == begin) {
            tree.MakeLeaf(node, leaves.size());
            leaves.emplace_back(begin, end);
            return;
        }
        const PointTree::Node n = tree.Nodes()[node];
        const auto isFirst = [&](const Point3 &p) { return p[int(n.axis)] < n.split; };
        isOrdered = isOrdered && std::all_of(begin, second, isFirst) && std::none_of(second, end, isFirst);
        Divide(n.below, begin, second, most);
        Divide(n.below + 1, second, end, most);
    }
};

TEST(PointTree, EveryPlaceIsInItsLeaf) {
    Rng rng(5);
    Built built;
    built.tree.Begin(2);
    std::vector<Point3> places(5000), others(300);
    for (Point3 &p : places) p = {rng.Uniform() * 8, rng.Uniform(), rng.Uniform() < 0.5f ? 0.25f : rng.Uniform()};
    for (Point3 &p : others) p = {rng.Uniform(), rng.Uniform() * 3, 1};
    built.Divide(0, places.data(), places.data() + places.size(), 100);
    const size_t ofFirst = built.leaves.size();
    built.Divide(1, others.data(), others.data() + others.size(), 100);
    EXPECT_TRUE(built.isOrdered);
    // Halves of halves of 5,000 have at most 100 after six times, and 300 after two. Those in a plane are not halves.
    EXPECT_GE(ofFirst, 50);
    EXPECT_LE(ofFirst, 100);
    EXPECT_EQ(built.leaves.size() - ofFirst, 4);
    size_t sum = 0;
    for (size_t leaf = 0; leaf < built.leaves.size(); ++leaf) {
        EXPECT_LE(built.leaves[leaf].size(), 100);
        sum += built.leaves[leaf].size();
        for (const Point3 &p : built.leaves[leaf]) EXPECT_EQ(built.tree.LeafOf(p, leaf < ofFirst ? 0 : 1), leaf);
    }
    EXPECT_EQ(sum, places.size() + others.size());
}

TEST(PointTree, DoesNotDivideWhatLiesInOnePoint) {
    Built built;
    built.tree.Begin(1);
    std::vector<Point3> places(1000, Point3(1, 2, 3));
    built.Divide(0, places.data(), places.data() + places.size(), 10);
    EXPECT_EQ(built.leaves.size(), 1);
    EXPECT_EQ(built.tree.Nodes().size(), 1);
}

TEST(PointTree, ADamagedOneIsInvalid) {
    Rng rng(6);
    Built built;
    built.tree.Begin(1);
    std::vector<Point3> places(1000);
    for (Point3 &p : places) p = {rng.Uniform(), rng.Uniform(), rng.Uniform()};
    built.Divide(0, places.data(), places.data() + places.size(), 100);
    const std::string saved = BytesOf(built.tree);
    const auto load = [&](const std::string &bytes, size_t roots, size_t leaves) {
        StateReader in(bytes, "tree");
        PointTree tree;
        in(tree);
        in.RequireValid(tree.ValidateFor(roots, leaves));
        EXPECT_EQ(BytesOf(tree), bytes);
    };
    load(saved, 1, built.leaves.size());
    EXPECT_THROW(load(saved, 1, built.leaves.size() - 1), UserError);
    EXPECT_THROW(load(saved, built.tree.Nodes().size() + 1, built.leaves.size()), UserError);
    const std::vector<PointTree::Node> &nodes = built.tree.Nodes();
    for (size_t i = 0; i < nodes.size(); ++i) {
        const auto expectThrow = [&](auto &&change) {
            PointTree::Node node = nodes[i];
            change(node);
            EXPECT_THROW(load(WithElement(saved, 0, i, node), 1, built.leaves.size()), UserError) << i;
        };
        expectThrow([](PointTree::Node &n) { n.axis = 4; });
        expectThrow([](PointTree::Node &n) { n.below = 0xffffffffu; });
        if (nodes[i].IsLeaf()) continue;
        // Behind the last node, itself, the children of another one, and neighbours that are not siblings.
        expectThrow([&](PointTree::Node &n) { n.below = uint32_t(nodes.size() - 1); });
        expectThrow([&](PointTree::Node &n) { n.below = uint32_t(i); });
        expectThrow([&](PointTree::Node &n) { n.below += n.below + 3 < nodes.size() ? 2 : -2; });
        expectThrow([&](PointTree::Node &n) { ++n.below; });
        expectThrow([](PointTree::Node &n) { n.split = std::numeric_limits<Float>::quiet_NaN(); });
    }
    std::string changed = saved;
    ++changed[sizeof(uint64_t) + offsetof(PointTree::Node, split)];
    EXPECT_THROW(load(changed, 1, built.leaves.size()), UserError) << "the hash does not fit";
}

}  // namespace
}  // namespace pbrt::test
