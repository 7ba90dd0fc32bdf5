#pragma once
#include <array>
#include <atomic>
#include <memory>

#include "ext/octree/cell_octree.h"
#include "ext/octree/sky_cut.h"
#include "ext/octree/sky_parts.h"

namespace ext {

/// An octree each of whose cells has a SkyCut for every sky, learned from rays. Rays are counted in integers, so that
/// threads may count in any order; between waves of the render, Learn makes them part of what is known.
class SkyCells {
  public:
    static constexpr size_t kMaxSkies = SkyParts::kMaxSkies;
    static constexpr size_t kLanes = 8;

    struct Settings {
        size_t tiles = 128;   ///< of a cut, at most
        Float floor = 0.05f;  ///< share of the weights that goes by irradiance alone
        size_t mostCells = 8192;
        /// A cell is divided after so many rays, if they times the gain (SkyCut::GainOfDividingTheCell) are worth it.
        uint64_t leastRays = 128;
        uint64_t freshRays = 16;  ///< before so many new rays nothing more is learned of a cell
        double worthDividing = 128;
        size_t manyPoints = 16;  ///< at first, cells may hold so many points
    };

    SkyCells() = default;
    /// One cell that sees the share `visible` of all tiles.
    SkyCells(const Bounds3 &bounds, std::span<const std::vector<uint32_t>> cuts, float visible,
             const Settings &settings);

    bool IsEmpty() const { return cells_.empty(); }
    size_t CellCount() const { return cells_.size(); }
    uint32_t CellAt(const Point3 &p) const { return octree_.Row(p); }

    /// Eight tiles side by side.
    struct alignas(32) Packet {
        Float x[kLanes] = {}, y[kLanes] = {}, z[kLanes] = {};
        Float sine[kLanes] = {}, quarterInvSine[kLanes] = {};
        Float weight[kLanes] = {};  ///< irradiance times (sqrt(v) + the cell's floor)
    };
    /// A cell as a light sampler reads it: of sky k the packets [first[k], first[k + 1]). Lanes that are not used have
    /// weight 0 and the key kNoKey.
    struct Row {
        std::array<uint32_t, kMaxSkies + 1> first = {};
        std::array<uint16_t, kMaxSkies> tiles = {};  ///< how many of the lanes are used
        bool isOpen = false;                         ///< nearly all of the skies is seen
    };
    static constexpr uint32_t kNoKey = ~0u;
    const Row &RowOf(uint32_t cell) const { return rows_[cell]; }
    const Packet *Packets() const { return packets_.data(); }
    uint32_t Number(size_t lane) const { return numbers_[lane]; }  ///< lanes are counted over all packets
    /// The tiles of a sky in a row as a binary tree: a node halves a square of the quadtree by y, its children halve
    /// the halves by x. Nodes are stored in preorder, as the number of tiles in the half of less y (or x): of a node
    /// with m of them, the first half is the next node, and the other one comes m nodes later.
    uint32_t TilesInFirstHalf(size_t firstLane, size_t node) const { return halves_[firstLane + node]; }
    /// The lane of the tile of sky k that holds the finest part with a key (SkyTiles::KeyTowards).
    size_t LaneOf(const Row &row, size_t k, uint32_t key) const;

    /// Counts a ray towards a tile. Any thread at any time, but not while Learn works.
    void Count(size_t lane, bool left) const {
        counts_[2 * lane + (left ? 1 : 0)].fetch_add(1, std::memory_order_relaxed);
    }
    /// Learns from what was counted. `divides`: cells that many rays were counted in are divided.
    void Learn(std::span<SkyTiles> skies, bool divides);
    /// Divides cells around these points, which are many of those that will be asked for.
    void DivideAround(std::span<const Point3> points, std::span<SkyTiles> skies);
    /// Frees what only learning needs.
    void EndLearning();

    uint64_t Traced() const { return traced_; }
    uint64_t Left() const { return left_; }
    double OpenShare() const;
    size_t TileCount() const { return tileCount_; }
    size_t Bytes() const;
    const CellOctree &Octree() const { return octree_; }
    /// The visible share of sky k as the cell knows it: weighted by the tiles' irradiance, or by their size, whichever
    /// is less.
    Float Visible(uint32_t cell, size_t k) const { return visible_[cell][k]; }

    /// All that is known, with the rays that were counted since Learn.
    void Save(StateWriter &writer) const;
    /// `skies`: how many there are.
    void Load(StateReader &reader, const Settings &settings, size_t skies);
    /// Empty, or what is wrong with cells that were read.
    std::optional<std::string> Validate(size_t skies) const;
    /// False if cells were saved without what only learning needs.
    bool CanLearn() const { return cells_.empty() || (counts_ && !cells_[0].cuts.empty()); }
    /// Calls visit(sky, tile number) for every tile that some cell learns of.
    template <class Visit>
    void ForEachLearnedTile(Visit &&visit) const {
        for (const Cell &cell : cells_)
            for (size_t k = 0; k < cell.cuts.size(); ++k)
                for (const SkyCut::Tile &tile : cell.cuts[k].Tiles()) visit(k, tile.number);
    }
    /// See LightLearner.
    void TakeFound(StateWriter &writer);
    void AddFound(StateReader &reader);

  private:
    struct Cell {
        std::vector<SkyCut> cuts;  ///< of each sky
        uint64_t rays = 0;         ///< since the cell was made
        uint64_t fresh = 0;        ///< that nothing was learned from yet
        Bounds3 box;
    };
    uint32_t AddCellLike(uint32_t cell);
    void Split(uint32_t node, uint32_t cell);
    void TakeCounts();
    void Adapt(std::span<SkyTiles> skies);
    void Divide(std::span<const SkyTiles> skies);
    void MakeRows(std::span<const SkyTiles> skies);
    size_t CountCount() const { return counts_ ? 2 * numbers_.size() : 0; }
    std::optional<std::string> ValidateCell(size_t cell, size_t skies) const;
    void MakeHalves(size_t firstLane, size_t tiles);

    Settings settings_;
    CellOctree octree_;
    std::vector<Cell> cells_;
    std::vector<Row> rows_;
    std::vector<Packet> packets_;
    std::vector<std::array<Float, kMaxSkies>> visible_;  ///< per cell
    std::vector<uint32_t> numbers_, keys_;               ///< per lane
    std::vector<uint8_t> halves_;                        ///< per lane: a node of the row's binary tree
    std::unique_ptr<std::atomic<uint64_t>[]> counts_;    ///< per lane: rays that met something, rays that left
    uint64_t traced_ = 0, left_ = 0;
    size_t tileCount_ = 0;
};

}  // namespace ext
