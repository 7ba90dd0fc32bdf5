// Learned structures from files: each fault is detected, although checksum and hashes fit.
#include <gtest/gtest.h>

#include "ext/visibility/visibility_records.h"
#include "pbrt/math/rng.h"
#include "support/errors.h"
#include "support/structure.h"

namespace {

using namespace ext;
using test::BytesOf, test::WithElement;

const Bounds3 kUnitBox(Point3(0), Point3(1));
/// Of CellOctree's nodes in the saved bytes, behind the box.
constexpr size_t kNodesAt = sizeof(Point3) + sizeof(Vector3);
constexpr uint32_t kLeaf = 0x80000000u;

VisibilityRecords Records() {
    VisibilityRecords made;
    Rng rng(3);
    for (int i = 0; i < 20000; ++i) {
        const Point3 p(rng.Uniform(), rng.Uniform(), rng.Uniform());
        made.records.push_back({p, uint32_t(made.rays.size()), 2});
        const bool seesFirst = p.x + p.y + p.z < Float(1.5);
        for (uint32_t l = 0; l < 2; ++l) made.rays.push_back({l, 0.5f, 0.5f, seesFirst == (l == 0) ? 1.f : 0.f});
    }
    return made;
}

VisibilityTree Tree() {
    const VisibilityRecords made = Records();
    return VisibilityTreeBuilder(kUnitBox, made.records, made.rays, {.lightCount = 2}).Build().value();
}

/// The message about the bytes; empty if they are accepted.
template <class T>
std::string Fault(const std::string &bytes) {
    return test::MessageOf([&] {
        StateReader reader(bytes, "state");
        T structure;
        reader(structure);
        reader.RequireEnd();
        EXPECT_EQ(BytesOf(structure), bytes);
    });
}

std::vector<uint32_t> NodesOf(const std::string &bytes) {
    StateReader reader(std::string_view(bytes).substr(kNodesAt), "nodes");
    std::vector<uint32_t> nodes;
    reader.Structure(nodes);
    return nodes;
}

TEST(Validate, AnOctreeWithEndlessLookUpsIsInvalid) {
    const std::string saved = BytesOf(Tree());
    ASSERT_EQ(Fault<VisibilityTree>(saved), "");
    const std::vector<uint32_t> nodes = NodesOf(saved);
    ASSERT_GT(nodes.size(), size_t{CellOctree::TopCount + 16});
    const uint32_t last = uint32_t(nodes.size()) - 8;
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        std::vector<uint32_t> wrong = {0, i, i & ~7u, last + 1, last + 8, 0x7fffffffu};
        if (nodes[i] & kLeaf) {
            wrong = {0, i, last, kLeaf | 0x7fffffffu};
        } else {
            wrong.insert(wrong.end(), {nodes[i] + 1, nodes[i] + 8, nodes[i] - 8, kLeaf});
        }
        for (const uint32_t node : wrong)
            if (node != nodes[i]) {
                EXPECT_NE(Fault<VisibilityTree>(WithElement(saved, kNodesAt, i, node)), "")
                    << "node " << i << ": " << nodes[i] << " -> " << node;
            }
    }
}

TEST(Validate, TheHashDetectsAChangedLeaf) {
    const std::string saved = BytesOf(Tree());
    const std::vector<uint32_t> nodes = NodesOf(saved);
    for (uint32_t i = 0; i < nodes.size(); ++i)
        for (uint32_t other : {nodes[i] ^ 1, kLeaf, uint32_t{0}}) {
            if (other == nodes[i]) continue;
            std::string changed = saved;
            std::memcpy(changed.data() + kNodesAt + sizeof(uint64_t) + i * sizeof(other), &other, sizeof(other));
            EXPECT_NE(Fault<VisibilityTree>(changed), "") << i;
        }
}

TEST(Validate, OneLevelBelowTheDeepestOctreeIsInvalid) {
    // A chain of first children, one level deeper than positions have bits.
    for (const bool isTooDeep : {false, true}) {
        CellOctree cells(kUnitBox);
        uint32_t node = 0;
        for (int depth = 2; depth < CellOctree::MaxDepth + (isTooDeep ? 1 : 0); ++depth) node = cells.Split(node);
        EXPECT_EQ(cells.ValidateFor(1).has_value(), isTooDeep);
    }
    EXPECT_TRUE(CellOctree(kUnitBox).ValidateFor(0)) << "no row for the leaves";
    EXPECT_FALSE(CellOctree(kUnitBox).ValidateLeaves(1, 1, 0));
    EXPECT_TRUE(CellOctree(kUnitBox).ValidateLeaves(2, 2, 0)) << "a row without a leaf";
}

TEST(Validate, EveryWrongRowMakesAnOctreeInvalid) {
    const std::string saved = BytesOf(Tree());
    const size_t offsetsAt = kNodesAt + 2 * sizeof(uint64_t) + NodesOf(saved).size() * sizeof(uint32_t);
    StateReader reader(std::string_view(saved).substr(offsetsAt), "offsets");
    std::vector<uint32_t> offsets;
    reader.Structure(offsets);
    ASSERT_GT(offsets.size(), 3u);
    for (size_t i = 0; i < offsets.size(); ++i)
        for (const uint32_t wrong : {0u, offsets[i] + 1000000, 0xffffffffu, offsets[(i + 1) % offsets.size()]})
            if (wrong != offsets[i]) {
                EXPECT_NE(Fault<VisibilityTree>(WithElement(saved, offsetsAt, i, wrong)), "") << i << " " << wrong;
            }
}

TEST(Validate, LengthsAreCheckedBeforeMemoryIsTaken) {
    const std::string saved = BytesOf(Tree());
    for (const uint64_t count : {uint64_t{1} << 60, uint64_t{1} << 32, ~uint64_t{0}}) {
        std::string changed = saved;
        std::memcpy(changed.data() + kNodesAt, &count, sizeof(count));
        EXPECT_NE(Fault<VisibilityTree>(changed).find("shorter"), std::string::npos) << count;
    }
    for (size_t bytes = 0; bytes < saved.size(); bytes += 37)
        EXPECT_NE(Fault<VisibilityTree>(saved.substr(0, bytes)), "") << bytes;
}

TEST(Validate, RecordsWithoutLightOrPlaceAreInvalid) {
    const VisibilityRecords good = Records();
    EXPECT_FALSE(good.ValidateFor(2, nullptr));
    EXPECT_TRUE(good.ValidateFor(1, nullptr)) << "the second light does not exist";
    const auto faultOf = [&](auto &&change) {
        VisibilityRecords changed = good;
        change(changed);
        return changed.ValidateFor(2, nullptr).has_value();
    };
    const Float nan = std::numeric_limits<Float>::quiet_NaN();
    EXPECT_TRUE(faultOf([&](VisibilityRecords &r) { r.records[5].p.y = nan; }));
    EXPECT_TRUE(faultOf([&](VisibilityRecords &r) { r.records[5].firstRay = 0; }));
    EXPECT_TRUE(faultOf([&](VisibilityRecords &r) { r.records[5].rayCount = 0xffffffffu; }));
    EXPECT_TRUE(faultOf([&](VisibilityRecords &r) { r.records.pop_back(); }));
    EXPECT_TRUE(faultOf([&](VisibilityRecords &r) { r.rays[7].light = 2; }));
    EXPECT_TRUE(faultOf([&](VisibilityRecords &r) { r.rays[7].ratio = Infinity; }));
    EXPECT_TRUE(faultOf([&](VisibilityRecords &r) { r.rays[7].share = -1; }));
}

}  // namespace
