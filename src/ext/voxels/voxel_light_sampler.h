#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "pbrt/core/parallel.h"
#include "pbrt/core/progress.h"
#include "pbrt/lightsamplers/group_light_sampler.h"
#include "pbrt/math/bounds.h"
#include "pbrt/math/rng.h"
#include "pbrt/scene/scene.h"

namespace ext {
using namespace pbrt;

/// Arrays of equal length, created lazily by any thread. A row must depend on its index only: threads that race for a
/// row each create it, one publishes, the others discard theirs, and none waits. The result is independent of timing.
/// Access to an existing row costs one load.
template <class T>
class LazyRows {
  public:
    LazyRows() = default;
    ~LazyRows() { Clear(); }
    LazyRows(const LazyRows &) = delete;
    LazyRows &operator=(const LazyRows &) = delete;

    /// Deletes all rows and sets their number and length. Not thread-safe.
    void Reset(size_t rows, size_t length) {
        Clear();
        rows_ = std::make_unique<std::atomic<T *>[]>(rows);
        count_ = rows;
        length_ = length;
        filled_ = discarded_ = 0;
        seconds_ = 0;
    }

    /// Returns the row, creating it with `fill` if missing, which must set every element of an uninitialized span of T.
    std::span<const T> Get(size_t row, const auto &fill) const {
        const T *values = rows_[row].load(std::memory_order_acquire);
        if (!values) [[unlikely]]
            values = Make(row, fill);
        return {values, length_};
    }

    size_t Size() const { return count_; }
    size_t Filled() const { return filled_.load(); }
    size_t Discarded() const { return discarded_.load(); }  ///< rows discarded because another thread published first
    double FillThreadSeconds() const { return seconds_.load(); }  ///< CPU time in `fill`, summed over threads
    size_t Bytes() const { return count_ * sizeof(T *) + Filled() * length_ * sizeof(T); }
    /// Adds times and numbers of rows that are voxels to a light sampler's report.
    void Report(auto &report, double prepareSeconds) const {
        report["prepassSeconds"] = 0.0;
        // Voxels are filled during rendering; a thread that fills does not render.
        report["buildSeconds"] = prepareSeconds + FillThreadSeconds() / std::max(1, pbrt::ThreadCount());
        report["fillThreadSeconds"] = FillThreadSeconds();
        report["voxels"] = Size();
        report["voxelsFilled"] = Filled();
        report["voxelsFilledTwice"] = Discarded();
    }

  private:
    template <class Fill>
    [[gnu::noinline]] const T *Make(size_t row, const Fill &fill) const {
        const double start = ClockSeconds(CLOCK_THREAD_CPUTIME_ID);
        std::unique_ptr<T[]> made(new T[length_]);
        fill(std::span<T>(made.get(), length_));
        seconds_ += ClockSeconds(CLOCK_THREAD_CPUTIME_ID) - start;
        T *expected = nullptr;
        if (!rows_[row].compare_exchange_strong(expected, made.get(), std::memory_order_acq_rel,
                                                std::memory_order_acquire)) {
            ++discarded_;
            return expected;
        }
        ++filled_;
        return made.release();
    }
    void Clear() {
        for (size_t i = 0; i < count_; ++i) delete[] rows_[i].load();
        count_ = 0;
    }

    std::unique_ptr<std::atomic<T *>[]> rows_;
    size_t count_ = 0, length_ = 0;
    mutable std::atomic<int64_t> filled_{0}, discarded_{0};
    mutable std::atomic<double> seconds_{0};  ///< CPU time in `fill`
};

/// Regular grid over a box with nearly cubic voxels. Look-up is index arithmetic.
class VoxelGrid {
  public:
    VoxelGrid() = default;
    /// `voxels` along the longest axis, others in proportion. An empty box gives one voxel of no extent at the origin.
    VoxelGrid(const Bounds3 &bounds, int voxels);

    /// Points outside are clamped to the grid; NaN maps to the first voxel.
    uint32_t Index(const Point3 &p) const {
        Vector3 q = (p - low_) * scale_;
        auto x = Clamped(q.x, resolution_.x), y = Clamped(q.y, resolution_.y), z = Clamped(q.z, resolution_.z);
        return x + uint32_t(resolution_.x) * (y + uint32_t(resolution_.y) * z);
    }
    size_t Size() const { return size_t(resolution_.x) * size_t(resolution_.y) * size_t(resolution_.z); }
    const glm::ivec3 &Resolution() const { return resolution_; }
    const Vector3 &VoxelSize() const { return size_; }
    /// Point of a voxel; u in [0, 1]^3.
    Point3 PointIn(uint32_t index, const Vector3 &u) const {
        const auto x = uint32_t(resolution_.x), y = uint32_t(resolution_.y);
        return low_ + (Vector3(glm::uvec3(index % x, index / x % y, index / x / y)) + u) * size_;
    }
    /// Voxels with a face on the grid's border: an estimate of the number of voxels with surfaces.
    size_t BorderSize() const;
    std::string Describe() const;  ///< a line with resolution and voxel size

  private:
    static uint32_t Clamped(Float q, int resolution) {
        return uint32_t(std::max(Float(0), std::min(q, Float(resolution - 1))));
    }

    Point3 low_{0, 0, 0};
    Vector3 scale_{0, 0, 0};  ///< voxels per unit length; 0 along an axis without extent
    Vector3 size_{0, 0, 0};
    glm::ivec3 resolution_{1, 1, 1};
};

// Discrete distribution with 4 bytes per entry: its start in the CDF, in units of 2^-32, from 0; the last entry ends at
// 1. Differences are exact: probabilities sum to 1, and small ones survive beside large ones, unlike with float running
// sums.

/// Builds a distribution proportional to the weights (>= 0, finite; uniform if all are 0), at least 2^-32 each.
void BuildFixedCdf(std::span<const double> weights, std::span<uint32_t> begins);

inline Float FixedCdfPMF(std::span<const uint32_t> begins, uint32_t index) {
    uint64_t end = index + 1 < begins.size() ? begins[index + 1] : uint64_t(1) << 32;
    return Float(end - begins[index]) * 0x1p-32f;
}

/// Entry for a uniform number u. A float near 1 has 24 bits, too few for narrow entries, so lower bits come from a hash
/// of u and the query point `p`.
uint32_t SampleFixedCdf(std::span<const uint32_t> begins, Float u, const Point3 &p);

/// Group light samplers with a distribution over the groups per voxel, created on first use. Uniform before Prepare.
class VoxelLightSampler : public GroupLightSampler {
  public:
    const void *WeighGroups(const LightQuery &query, LightMemory &) const final { return Cdf(query.p).data(); }
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const final {
        if (!weights) return SampleUniformly(query, u);
        const std::span<const uint32_t> cdf = Weighed(weights);
        const uint32_t group = SampleFixedCdf(cdf, u, query.p);
        const Float pmf = FixedCdfPMF(cdf, group);
        return ChosenGroup{group, pmf, LightGroups::InnerNumber(u, query.p, Float(cdf[group]) * 0x1p-32f, pmf)};
    }
    Float GroupProbability(const LightQuery &, const void *weights, uint32_t group) const final {
        return weights ? FixedCdfPMF(Weighed(weights), group) : 1 / Float(groups_.Size());
    }

  protected:
    using GroupLightSampler::GroupLightSampler;
    /// For Prepare. `voxels`: along the longest axis of the scene.
    void PrepareVoxels(const PrepareContext &context, int voxels) {
        seed_ = context.seed;
        grid_ = VoxelGrid(context.scene.Bounds(), voxels);
        cdfs_.Reset(grid_.Size(), groups_.Size());
    }
    bool IsPrepared() const { return cdfs_.Size() > 0; }
    /// Weights of the groups in a voxel (>= 0, finite), in proportion to which they are selected.
    virtual std::vector<double> Weights(uint32_t voxel) const = 0;
    /// Distribution of the voxel that contains p, in fixed point (BuildFixedCdf). Its address is stable until the next
    /// Prepare. Empty before Prepare: uniform.
    std::span<const uint32_t> Cdf(const Point3 &p) const {
        if (!IsPrepared()) return {};
        const uint32_t voxel = grid_.Index(p);
        return cdfs_.Get(voxel, [&](std::span<uint32_t> begins) { BuildFixedCdf(Weights(voxel), begins); });
    }

    int seed_ = 0;
    VoxelGrid grid_;
    LazyRows<uint32_t> cdfs_;  ///< per voxel
    double prepareSeconds_ = 0;

  private:
    std::span<const uint32_t> Weighed(const void *weights) const {
        return {static_cast<const uint32_t *>(weights), groups_.Size()};
    }
};

}  // namespace ext
