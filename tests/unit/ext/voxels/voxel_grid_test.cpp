#include <gtest/gtest.h>

#include "ext/voxels/voxel_light_sampler.h"
#include "pbrt/math/rng.h"

namespace {

using namespace ext;

const Bounds3 kBounds(Point3(-1, -0.5f, 2), Point3(7, 1.5f, 5));  // 8 x 2 x 3

TEST(VoxelGrid, VoxelsAreNearlyCubesAndFillTheBounds) {
    VoxelGrid grid(kBounds, 16);
    EXPECT_EQ(grid.Resolution(), glm::ivec3(16, 4, 6));
    EXPECT_EQ(grid.Size(), 16u * 4u * 6u);
    EXPECT_EQ(grid.VoxelSize(), Vector3(0.5f));
    double volume = 0;
    for (uint32_t i = 0; i < grid.Size(); ++i) {
        Vector3 d = grid.PointIn(i, Vector3(1)) - grid.PointIn(i, Vector3(0));
        volume += double(d.x * d.y * d.z);
    }
    EXPECT_NEAR(volume, 8 * 2 * 3, 1e-4);
    EXPECT_EQ(grid.PointIn(0, Vector3(0)), kBounds.low);
    EXPECT_EQ(grid.PointIn(16 * 4 * 6 - 1, Vector3(1)), kBounds.high);
    // All but the 14 x 2 x 4 in the middle.
    EXPECT_EQ(grid.BorderSize(), grid.Size() - 14u * 2u * 4u);
}

TEST(VoxelGrid, APointIsInTheVoxelOfItsIndex) {
    VoxelGrid grid(kBounds, 13);
    Rng rng(3);
    for (int i = 0; i < 5000; ++i) {
        Point3 p = kBounds.low + kBounds.Diagonal() * Vector3{rng.Uniform(), rng.Uniform(), rng.Uniform()};
        uint32_t voxel = grid.Index(p);
        ASSERT_LT(voxel, grid.Size());
        const Point3 low = grid.PointIn(voxel, Vector3(0)), high = grid.PointIn(voxel, Vector3(1));
        for (int k = 0; k < 3; ++k) {
            EXPECT_GE(p[k], low[k] - 1e-5f);
            EXPECT_LE(p[k], high[k] + 1e-5f);
        }
        Vector3 inside{0.01f + 0.98f * rng.Uniform(), 0.01f + 0.98f * rng.Uniform(), 0.01f + 0.98f * rng.Uniform()};
        EXPECT_EQ(grid.Index(grid.PointIn(voxel, inside)), voxel);
    }
}

TEST(VoxelGrid, PointsOutsideBelongToTheNearestVoxel) {
    VoxelGrid grid(kBounds, 16);
    EXPECT_EQ(grid.Index(Point3(-100)), 0u);
    EXPECT_EQ(grid.Index(Point3(1e30f)), grid.Size() - 1);
    EXPECT_EQ(grid.Index({Infinity, -Infinity, -Infinity}), 15u);
    EXPECT_EQ(grid.Index({3.1f, 50, 2.1f}), grid.Index({3.1f, 1.4f, 2.1f}));
    EXPECT_LT(grid.Index(Point3(std::numeric_limits<Float>::quiet_NaN())), grid.Size());
}

TEST(VoxelGrid, BoundsWithoutExtent) {
    EXPECT_EQ(VoxelGrid().Index({3, 4, 5}), 0u);
    EXPECT_EQ(VoxelGrid(Bounds3(), 16).Size(), 1u);
    EXPECT_EQ(VoxelGrid(Bounds3(Point3(1, 2, 3)), 16).Size(), 1u);
    EXPECT_EQ(VoxelGrid(Bounds3(Point3(1, 2, 3)), 16).PointIn(0, Vector3(0.5f)), Point3(1, 2, 3));
    VoxelGrid flat(Bounds3(Point3(0), Point3(4, 0, 2)), 8);
    EXPECT_EQ(flat.Resolution(), glm::ivec3(8, 1, 4));
    EXPECT_EQ(flat.Index({3.9f, 0, 1.9f}), 31u);
}

TEST(VoxelGrid, SmallAndLargeScenesHaveTheSameVoxels) {
    for (Float scale : {1e-4f, 1e4f}) {
        VoxelGrid one(kBounds, 16), other(Bounds3(kBounds.low * scale, kBounds.high * scale), 16);
        Rng rng(5);
        for (int i = 0; i < 1000; ++i) {
            auto voxel = rng.UniformInt(uint32_t(one.Size()));
            EXPECT_EQ(other.Index(one.PointIn(voxel, Vector3(0.5f)) * scale), voxel);
        }
    }
}

}  // namespace
