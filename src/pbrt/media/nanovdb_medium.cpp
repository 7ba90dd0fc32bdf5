#include <array>
#include <filesystem>
#include <fstream>
#include <iostream>  // required by NanoVDB

#include "pbrt/core/error.h"
#include "pbrt/core/memory.h"
#include "pbrt/media/medium_kinds.h"

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
    if (!file || std::filesystem::is_directory(path, none)) throw UserError("{}: the file cannot be opened.", path);
    std::array<char, 8> magic{};
    file.read(magic.data(), magic.size());
    const std::string_view found(magic.data(), size_t(file.gcount()));
    if (found == "NanoVDB0") return;
    if (found.starts_with("NanoVDB"))
        throw UserError(
            "{}: the file was written by a newer version of NanoVDB (it begins with \"{}\"); "
            "versions up to {}, whose files begin with \"NanoVDB0\", can be read.",
            path, found, NANOVDB_MAJOR_VERSION_NUMBER);
    if (found.starts_with(" BDV"))
        throw UserError("{}: this is an OpenVDB file; the program nanovdb_convert turns it into a NanoVDB file.", path);
    throw UserError("{}: this is not a NanoVDB file.", path);
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
        return ++visited[level] <= tree.nodeCount(int(level)) && holds(&node, sizeof(node));
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
        if (visited[level] != tree.nodeCount(int(level))) return false;
    return true;
}

/// A grid of a file, with its memory. Empty if the file has no such grid.
class VdbGrid {
  public:
    VdbGrid() = default;
    VdbGrid(const std::string &path, const nanovdb::io::GridMetaData &data) {
        const std::string what = fmt::format("{}: grid \"{}\"", path, Abbreviate(data.gridName));
        if (data.gridType != nanovdb::GridType::Float)
            throw UserError("{} holds values of type {}; only float is possible.", what, nanovdb::toStr(data.gridType));
        if (data.gridClass != nanovdb::GridClass::FogVolume && data.gridClass != nanovdb::GridClass::Unknown)
            throw UserError("{} is of class {}; only fog volumes are possible.", what, nanovdb::toStr(data.gridClass));
        RequireMemory(double(data.gridSize), what, {});
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
            throw UserError("{}: the file has no grid \"{}\"; {}.", request.path, Abbreviate(request.densityName),
                            ListChoices(request.densityName, names));
    } catch (const UserError &) {
        throw;
    } catch (const std::exception &e) {  // NanoVDB's exceptions, and allocation failure for invalid sizes
        throw UserError("{}: the file is damaged or cannot be read: {}.", request.path, e.what());
    }
    return grids;
}

Float Interpolate(const Accessor &accessor, const Point3 &p) {
    const Vector3 low = glm::floor(p), w = p - low;
    const nanovdb::Coord first(int(low.x), int(low.y), int(low.z));
    std::array<Float, 4> alongZ;
    for (int i = 0; i < 4; ++i) {
        const nanovdb::Coord at = first.offsetBy(i & 1, i >> 1, 0);
        alongZ[i] = Lerp(w.z, accessor.getValue(at), accessor.getValue(at.offsetBy(0, 0, 1)));
    }
    return Lerp(w.y, Lerp(w.x, alongZ[0], alongZ[1]), Lerp(w.x, alongZ[2], alongZ[3]));
}

/// Largest value of the voxels in a box of index space.
class MaxInBox {
  public:
    using Index = glm::vec<3, int64_t>;
    /// Voxels from `low` to `high`, inclusive.
    MaxInBox(const Index &low, const Index &high) : low_(low), high_(high) {}

    /// At least 0 and the background; infinite if a value in the box is not finite.
    Float Of(const FloatGrid &grid) {
        const auto &root = *grid.tree().root().data();
        max_ = std::max(Float(0), grid.tree().background());
        for (uint32_t i = 0; i < root.mTableSize; ++i) {
            const auto *tile = root.tile(i);
            const Index origin(tile->origin()[0], tile->origin()[1], tile->origin()[2]);
            if (tile->isChild()) Visit(*root.getChild(tile), origin);
            else if (glm::all(glm::lessThanEqual(origin, high_)) && glm::all(glm::lessThan(low_, origin + kTileSize)))
                Take(tile->value);
        }
        return max_;
    }

  private:
    static constexpr int64_t kTileSize = nanovdb::NanoUpper<float>::DIM;

    /// `origin`: the node's first voxel.
    template <class Node>
    void Visit(const Node &node, const Index &origin) {
        constexpr int64_t kLog2Slots = Node::LOG2DIM, kLog2Size = Node::TOTAL - Node::LOG2DIM;  // per axis; of a slot
        const Index first = glm::max(low_ - origin, Index(0)) >> kLog2Size;
        const Index last = glm::min((high_ - origin) >> kLog2Size, Index((1 << kLog2Slots) - 1));
        for (int64_t x = first.x; x <= last.x; ++x)
            for (int64_t y = first.y; y <= last.y; ++y)
                for (int64_t z = first.z; z <= last.z; ++z) {
                    const auto slot = uint32_t((x << kLog2Slots | y) << kLog2Slots | z);
                    if constexpr (Node::LEVEL == 0) Take(node.getValue(slot));
                    else if (node.childMask().isOn(slot))
                        Visit(*node.data()->getChild(slot), origin + (Index(x, y, z) << kLog2Size));
                    else Take(node.data()->mTable[slot].value);
                }
    }
    void Take(Float value) { max_ = std::isfinite(value) ? std::max(max_, value) : Infinity; }

    Index low_, high_;
    Float max_ = 0;
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
        majorants_ = MajorantGrid(cells, [&](const glm::ivec3 &cell) {
            using Index = MaxInBox::Index;
            // Values influence points less than 1 away.
            MaxInBox reach(Index(glm::floor(ToIndex(Point3(cell)))), Index(glm::ceil(ToIndex(Point3(cell + 1)))));
            const Float max = reach.Of(*grids_.density);
            if (max == Infinity)
                throw UserError("{}: grid \"{}\" holds a density that is not a number or infinite.", request.path,
                                Abbreviate(request.densityName));
            return kMajorantSlack * max;
        });
    }

    size_t Bytes() const override {
        return sizeof(*this) + spectra_.Bytes() + majorants_.Bytes() + grids_.density.Bytes() +
               grids_.temperature.Bytes();
    }

    MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const override {
        MediumOnRay onRay(*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, spectra_.Sample(lambda));
        const VdbGrid &temperature = grids_.temperature ? grids_.temperature : grids_.density;
        OnRay &memory = onRay.MakeMemory(OnRay{grids_.density->getAccessor(), temperature->getAccessor(), {}, {}});
        if (IsEmissive() && onRay.Walk().Anchor() < Infinity) {
            const glm::dvec3 d(ray.d);
            memory.origin = Point3(temperatureFromRender_.Point(glm::dvec3(ray.o) + d * double(onRay.Walk().Anchor())));
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

    /// Maps majorant coordinates to the density's index space; see Voxels::ToVoxels.
    Point3 ToIndex(const Point3 &p) const {
        return {std::fma(p.x, indicesPerCell_.x, Float(low_.x)), std::fma(p.y, indicesPerCell_.y, Float(low_.y)),
                std::fma(p.z, indicesPerCell_.z, Float(low_.z))};
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
        throw UserError("{}: grid \"{}\" is empty.", request.path, Abbreviate(request.densityName));
    return std::make_unique<NanoVdbMedium>(request, std::move(grids), std::move(spectra), g, renderFromMedium);
}

}  // namespace pbrt
