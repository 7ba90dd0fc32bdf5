#include "pbrt/media/nanovdb_medium.h"

#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iostream>  // required by NanoVDB

#include "pbrt/core/error.h"
#include "pbrt/core/memory.h"
#include "pbrt/core/parallel.h"

#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/GridValidator.h>
#include <nanovdb/util/IO.h>

namespace pbrt {

namespace {

using FloatGrid = nanovdb::NanoGrid<float>;
using Accessor = nanovdb::DefaultReadAccessor<float>;
using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;

/// Throws UserError unless this NanoVDB version can read the file.
void CheckMagic(const std::string &path) {
    std::ifstream file(path, std::ios::binary);
    std::error_code none;
    if (!file || std::filesystem::is_directory(path, none))
        throw UserError(fmt::format("{}: the file cannot be opened.", path));
    std::array<char, 8> magic{};
    file.read(magic.data(), magic.size());
    const std::string_view found(magic.data(), static_cast<size_t>(file.gcount()));
    if (found == "NanoVDB0") return;
    if (found.starts_with("NanoVDB"))
        throw UserError(
            fmt::format("{}: the file was written by a newer version of NanoVDB (it begins with \"{}\"); "
                        "versions up to {}, whose files begin with \"NanoVDB0\", can be read.",
                        path, found, NANOVDB_MAJOR_VERSION_NUMBER));
    if (found.starts_with(" BDV"))
        throw UserError(
            fmt::format("{}: this is an OpenVDB file; the program nanovdb_convert turns it into a NanoVDB "
                        "file.",
                        path));
    throw UserError(fmt::format("{}: this is not a NanoVDB file.", path));
}

/// True if all tree nodes lie within the grid's `bytes` of memory, so that values can be read. NanoVDB's own check does
/// not visit all of them.
bool IsSound(const FloatGrid &grid, size_t bytes) {
    const auto begin = reinterpret_cast<uintptr_t>(&grid);
    auto holds = [&](const void *p, uint64_t size) {
        const uintptr_t offset = reinterpret_cast<uintptr_t>(p) - begin;
        return offset % NANOVDB_DATA_ALIGNMENT == 0 && offset <= bytes && size <= bytes - offset;
    };
    if (bytes < sizeof(nanovdb::GridData) + sizeof(nanovdb::NanoTree<float>) || grid.gridSize() != bytes) return false;
    const auto &tree = grid.tree();
    const auto &root = tree.root();
    if (!holds(&root, sizeof(root)) || !holds(&root, root.memUsage())) return false;
    // A damaged tree may refer to a node repeatedly: visits are limited by its node counts.
    std::array<uint64_t, 3> visited{};
    auto isFine = [&](const auto &node, size_t level) {
        return ++visited[level] <= tree.nodeCount(static_cast<int>(level)) && holds(&node, sizeof(node));
    };
    for (auto upper = root.beginChild(); upper; ++upper) {
        if (!isFine(*upper, 2)) return false;
        for (auto lower = upper->beginChild(); lower; ++lower) {
            if (!isFine(*lower, 1)) return false;
            for (auto leaf = lower->beginChild(); leaf; ++leaf)
                if (!isFine(*leaf, 0)) return false;
        }
    }
    for (size_t level = 0; level < 3; ++level)
        if (visited[level] != tree.nodeCount(static_cast<int>(level))) return false;
    return true;
}

/// A grid of a file, with its memory. Empty if the file has no such grid.
class VdbGrid {
  public:
    VdbGrid() = default;
    VdbGrid(const std::string &path, const nanovdb::io::GridMetaData &data) {
        const std::string what = fmt::format("{}: grid \"{}\"", path, Abbreviate(data.gridName));
        if (data.gridType != nanovdb::GridType::Float)
            throw UserError(fmt::format("{} holds values of type {}; only float is possible.", what,
                                        nanovdb::toStr(data.gridType)));
        RequireMemory(static_cast<double>(data.gridSize), what, {});
        handle_ = nanovdb::io::readGrid(path, data.gridName);
        if (handle_.size() >= sizeof(nanovdb::GridData)) grid_ = handle_.grid<float>();
        if (!grid_ || !IsSound(*grid_, handle_.size()) || !nanovdb::isValid(*grid_))
            throw UserError(what + " is damaged.");
    }
    explicit operator bool() const { return grid_ != nullptr; }
    const FloatGrid &operator*() const { return *grid_; }
    const FloatGrid *operator->() const { return grid_; }
    size_t Bytes() const { return handle_.size(); }

    AffineMap IndexFromWorld() const {
        auto at = [this](double x, double y, double z) {
            const nanovdb::Vec3d p = grid_->worldToIndex(nanovdb::Vec3d(x, y, z));
            return glm::dvec3(p[0], p[1], p[2]);
        };
        const glm::dvec3 o = at(0, 0, 0);
        return {glm::dmat3(at(1, 0, 0) - o, at(0, 1, 0) - o, at(0, 0, 1) - o), o};
    }

  private:
    Handle handle_;
    const FloatGrid *grid_ = nullptr;
};

struct VdbGrids {
    VdbGrid density, temperature;
};

VdbGrids ReadGrids(const NanoVdbRequest &request) {
    CheckMagic(request.path);
    VdbGrids grids;
    try {
        std::vector<std::string> names;
        for (const nanovdb::io::GridMetaData &data : nanovdb::io::readGridMetaData(request.path)) {
            names.push_back(data.gridName);
            if (data.gridName == request.densityName && !grids.density) grids.density = VdbGrid(request.path, data);
            if (data.gridName == request.temperatureName && !grids.temperature)
                grids.temperature = VdbGrid(request.path, data);
        }
        if (!grids.density)
            throw UserError(fmt::format("{}: the file has no grid \"{}\"; {}.", request.path,
                                        Abbreviate(request.densityName), ListChoices(request.densityName, names)));
    } catch (const UserError &) {
        throw;
    } catch (const std::exception &e) {  // NanoVDB's exceptions, and allocation failure for invalid sizes
        throw UserError(fmt::format("{}: the file is damaged or cannot be read: {}.", request.path, e.what()));
    }
    return grids;
}

Float Interpolate(const Accessor &accessor, const Point3 &p) {
    const Vector3 low = glm::floor(p), w = p - low;
    const nanovdb::Coord first(static_cast<int>(low.x), static_cast<int>(low.y), static_cast<int>(low.z));
    std::array<Float, 4> alongZ;
    for (int i = 0; i < 4; ++i) {
        const nanovdb::Coord at = first.offsetBy(i & 1, i >> 1, 0);
        alongZ[i] = Lerp(w.z, accessor.getValue(at), accessor.getValue(at.offsetBy(0, 0, 1)));
    }
    return Lerp(w.y, Lerp(w.x, alongZ[0], alongZ[1]), Lerp(w.x, alongZ[2], alongZ[3]));
}

/// Density upper bounds in grid cells over a box of index space.
class DensityBounds {
  public:
    /// Index coordinates are low + perCell * p, p in majorant coordinates.
    DensityBounds(const glm::ivec3 &low, const Vector3 &perCell, const glm::ivec3 &cells)
        : low_(low), perCell_(perCell), cells_(cells) {
        max_ = std::vector<std::atomic<Float>>(static_cast<size_t>(cells.x) * static_cast<size_t>(cells.y) *
                                               static_cast<size_t>(cells.z));
    }

    /// Maps majorant coordinates to index space along an axis; see Voxels::ToVoxels.
    static Float ToIndex(Float p, Float perCell, int low) { return std::fma(p, perCell, static_cast<Float>(low)); }

    void Take(const FloatGrid &grid) {
        const auto &root = grid.tree().root();
        // Lower nodes are cubes of 128^3 voxels.
        std::vector<const Lower *> lowers;
        for (auto upper = root.beginChild(); upper; ++upper) {
            for (auto lower = upper->beginChild(); lower; ++lower) lowers.push_back(&*lower);
            TakeTiles(*upper, Lower::DIM);
        }
        for (uint32_t i = 0; i < root.data()->mTableSize; ++i)
            if (const auto *tile = root.data()->tile(i); !tile->isChild())
                TakeCube(tile->origin(), Lower::DIM * kLowersPerUpper, tile->value);
        ParallelForEach(static_cast<int64_t>(lowers.size()), [&](int64_t i) {
            const Lower &lower = *lowers[i];
            for (auto leaf = lower.beginChild(); leaf; ++leaf) TakeLeaf(*leaf);
            TakeTiles(lower, Leaf::DIM);
        });
        if (grid.tree().background() != 0)
            for (std::atomic<Float> &max : max_) Raise(max, grid.tree().background());
    }
    bool IsFinite() const { return isFinite_; }
    Float operator()(const glm::ivec3 &cell) const { return max_[IndexOf(cell)]; }

  private:
    using Lower = nanovdb::NanoLower<float>;
    using Leaf = nanovdb::NanoLeaf<float>;
    static constexpr int kLowersPerUpper = 32;
    struct Cells {
        int first, last;  ///< empty if last < first
    };

    /// Cells influenced by values from index `from` to `to`: those less than 1 away.
    Cells CellsOf(int axis, int from, int to) const {
        const auto below = static_cast<double>(from - 1), above = static_cast<double>(to + 1);
        auto cellAt = [&](double index) {
            const double cell = (index - low_[axis]) / static_cast<double>(perCell_[axis]);
            return static_cast<int>(std::clamp(std::floor(cell), -2.0, static_cast<double>(cells_[axis]) + 2));
        };
        auto index = [&](int cell) {
            return static_cast<double>(ToIndex(static_cast<Float>(cell), perCell_[axis], low_[axis]));
        };
        // One more on each side for rounding in the division, then restricted to the cells actually reached.
        Cells c{std::max(cellAt(below) - 1, 0), std::min(cellAt(above) + 1, cells_[axis] - 1)};
        while (c.first <= c.last && index(c.first + 1) <= below) ++c.first;
        while (c.first <= c.last && index(c.last) >= above) --c.last;
        return c;
    }
    size_t IndexOf(const glm::ivec3 &cell) const {
        return static_cast<size_t>((cell.z * cells_.y + cell.y) * cells_.x + cell.x);
    }
    static void Raise(std::atomic<Float> &max, Float value) {
        Float known = max.load(std::memory_order_relaxed);
        while (known < value && !max.compare_exchange_weak(known, value, std::memory_order_relaxed)) {
        }
    }
    void Spread(const std::array<Cells, 3> &cells, Float value) {
        if (!std::isfinite(value)) isFinite_ = false;
        if (!(value > 0)) return;
        for (int z = cells[2].first; z <= cells[2].last; ++z)
            for (int y = cells[1].first; y <= cells[1].last; ++y)
                for (int x = cells[0].first; x <= cells[0].last; ++x) Raise(max_[IndexOf({x, y, z})], value);
    }
    void TakeCube(const nanovdb::Coord &origin, int size, Float value) {
        if (value == 0) return;
        std::array<Cells, 3> cells;
        for (int a = 0; a < 3; ++a) cells[a] = CellsOf(a, origin[a], origin[a] + (size - 1));
        Spread(cells, value);
    }
    template <class Node>
    void TakeTiles(const Node &node, int size) {
        for (uint32_t n = 0; n < Node::SIZE; ++n)
            if (!node.childMask().isOn(n)) TakeCube(node.offsetToGlobalCoord(n), size, node.data()->mTable[n].value);
    }
    void TakeLeaf(const Leaf &leaf) {
        constexpr int kSize = Leaf::DIM;
        std::array<std::array<Cells, kSize>, 3> cells;
        const nanovdb::Coord origin = leaf.origin();
        for (int a = 0; a < 3; ++a)
            for (int i = 0; i < kSize; ++i) cells[a][i] = CellsOf(a, origin[a] + i, origin[a] + i);
        for (uint32_t n = 0; n < kSize * kSize * kSize; ++n) {
            const nanovdb::Coord at = Leaf::OffsetToLocalCoord(n);
            Spread({cells[0][at[0]], cells[1][at[1]], cells[2][at[2]]}, leaf.getValue(n));
        }
    }

    glm::ivec3 low_;
    Vector3 perCell_;
    glm::ivec3 cells_;
    std::vector<std::atomic<Float>> max_;
    std::atomic<bool> isFinite_ = true;
};

class NanoVdbMedium final : public Medium {
  public:
    NanoVdbMedium(const NanoVdbRequest &request, VdbGrids grids, MediumSpectra spectra, Float g,
                  const Transform &renderFromMedium)
        : Medium(g, grids.temperature && request.thermal.scale > 0 && spectra.absorption.MaxValue() > 0),
          spectra_(std::move(spectra)), grids_(std::move(grids)), thermal_(request.thermal) {
        const AffineMap mediumFromRender = AffineMap(glm::dmat4(renderFromMedium.Matrix())).Inverse();
        const auto &box = grids_.density->indexBBox();
        // Values fade to the background over one voxel around the active ones.
        low_ = glm::ivec3(box.min()[0], box.min()[1], box.min()[2]) - 1;
        const glm::ivec3 high = glm::ivec3(box.max()[0], box.max()[1], box.max()[2]) + 1;
        const glm::ivec3 cells = MajorantCells(high - low_, 4, kMaxCells);
        indicesPerCell_ = Vector3(high - low_) / Vector3(cells);
        gridFromRender_ = AffineMap::ToBox(low_, high, cells) * grids_.density.IndexFromWorld() * mediumFromRender;
        if (grids_.temperature) temperatureFromRender_ = grids_.temperature.IndexFromWorld() * mediumFromRender;
        DensityBounds bounds(low_, indicesPerCell_, cells);
        bounds.Take(*grids_.density);
        if (!bounds.IsFinite())
            throw UserError(fmt::format("{}: grid \"{}\" holds a density that is not a number or infinite.",
                                        request.path, Abbreviate(request.densityName)));
        majorants_ = MajorantGrid(cells, [&](const glm::ivec3 &cell) { return kMajorantSlack * bounds(cell); });
    }

    size_t Bytes() const override {
        return sizeof(*this) + spectra_.Bytes() + majorants_.Bytes() + grids_.density.Bytes() +
               grids_.temperature.Bytes();
    }

    MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const override {
        const MediumCoefficients unit = spectra_.Sample(lambda);
        MediumOnRay onRay(*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, unit,
                          unit.absorption + unit.scattering);
        const VdbGrid &temperature = grids_.temperature ? grids_.temperature : grids_.density;
        OnRay &memory = onRay.MakeMemory(OnRay{grids_.density->getAccessor(), temperature->getAccessor(), {}, {}});
        if (IsEmissive() && onRay.Walk().Anchor() < Infinity) {
            const glm::dvec3 d(ray.d);
            memory.origin = Point3(
                temperatureFromRender_.Point(glm::dvec3(ray.o) + d * static_cast<double>(onRay.Walk().Anchor())));
            memory.direction = Vector3(temperatureFromRender_.Vector(d));
        }
        return onRay;
    }

  private:
    /// Per-ray state: tree accessors, and the ray in the temperature's index space, starting at the walk's anchor.
    struct OnRay {
        Accessor density, temperature;
        Point3 origin;
        Vector3 direction;
    };
    static constexpr int kMaxCells = 64;

    /// Maps majorant coordinates to the density's index space.
    Point3 ToIndex(const Point3 &p) const {
        return {DensityBounds::ToIndex(p.x, indicesPerCell_.x, low_.x),
                DensityBounds::ToIndex(p.y, indicesPerCell_.y, low_.y),
                DensityBounds::ToIndex(p.z, indicesPerCell_.z, low_.z)};
    }

    MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const override {
        const OnRay &memory = onRay.Memory<OnRay>();
        const Float density = std::max(Float(0), Interpolate(memory.density, ToIndex(onRay.Walk().At(t))));
        MediumCoefficients c = onRay.Unit();
        c.absorption *= density;
        c.scattering *= density;
        if (IsEmissive() && density > 0) {
            const Point3 p = memory.origin + memory.direction * (t - onRay.Walk().Anchor());
            c.emission = thermal_.At(Interpolate(memory.temperature, p), onRay.Lambda());
        }
        return c;
    }

    MediumSpectra spectra_;
    VdbGrids grids_;
    ThermalEmission thermal_;
    glm::ivec3 low_{0};  ///< index coordinates of the majorants' low corner
    Vector3 indicesPerCell_{};
    MajorantGrid majorants_;
    AffineMap gridFromRender_, temperatureFromRender_;
};

}  // namespace

std::unique_ptr<Medium> MakeNanoVdbMedium(const NanoVdbRequest &request, MediumSpectra spectra, Float g,
                                          const Transform &renderFromMedium) {
    VdbGrids grids = ReadGrids(request);
    if (grids.density->isEmpty())
        throw UserError(fmt::format("{}: grid \"{}\" is empty.", request.path, Abbreviate(request.densityName)));
    return std::make_unique<NanoVdbMedium>(request, std::move(grids), std::move(spectra), g, renderFromMedium);
}

}  // namespace pbrt
