#include "ext/lab/convergence.h"

#include <algorithm>
#include <cmath>

namespace ext::lab {

namespace {

// Replaces increasing errors by the geometric mean of the violating points, until none increases.
void LevelRises(std::vector<CurvePoint> &points) {
    struct Block {
        double logSum;
        size_t count;
        double Mean() const { return logSum / static_cast<double>(count); }
    };
    std::vector<Block> blocks;
    for (const CurvePoint &p : points) {
        blocks.push_back({std::log(p.error), 1});
        while (blocks.size() > 1 && blocks[blocks.size() - 2].Mean() < blocks.back().Mean()) {
            const Block last = blocks.back();
            blocks.pop_back();
            blocks.back().logSum += last.logSum;
            blocks.back().count += last.count;
        }
    }
    size_t i = 0;
    for (const Block &block : blocks) {
        // Points that agree with their neighbours keep their exact error.
        for (size_t k = 0; k < block.count; ++k, ++i)
            if (block.count > 1) points[i].error = std::exp(block.Mean());
    }
}

// y at x on the line through (x0, y0) and (x1, y1) in log-log.
double LogLog(double x, double x0, double y0, double x1, double y1) {
    const double t = std::log(x / x0) / std::log(x1 / x0);
    return y0 * std::pow(y1 / y0, t);
}

}  // namespace

ErrorCurve::ErrorCurve(std::vector<CurvePoint> points, double fixedCost) : fixedCost_(fixedCost) {
    for (const CurvePoint &p : points)
        if (std::isfinite(p.cost) && std::isfinite(p.error) && p.cost > 0 && p.error > 0) points_.push_back(p);
    std::sort(points_.begin(), points_.end(), [](const CurvePoint &a, const CurvePoint &b) { return a.cost < b.cost; });
    LevelRises(points_);
    if (!points_.empty()) fixedCost_ = std::clamp(fixedCost_, 0.0, points_.back().cost);
}

std::optional<ErrorCurve::Reading> ErrorCurve::ErrorAt(double cost) const {
    if (points_.empty() || !(cost >= points_.front().cost)) return {};
    const CurvePoint &last = points_.back();
    if (cost > last.cost) return Reading{last.error * (last.cost - fixedCost_) / (cost - fixedCost_), true};
    auto next = std::lower_bound(points_.begin(), points_.end(), cost,
                                 [](const CurvePoint &p, double c) { return p.cost < c; });
    if (next->cost == cost) return Reading{next->error, false};
    const CurvePoint &before = *std::prev(next);
    return Reading{LogLog(cost, before.cost, before.error, next->cost, next->error), false};
}

std::optional<ErrorCurve::Reading> ErrorCurve::CostToReach(double error) const {
    if (points_.empty() || !(error > 0) || points_.front().error < error) return {};
    const CurvePoint &last = points_.back();
    if (last.error > error) return Reading{fixedCost_ + (last.cost - fixedCost_) * (last.error / error), true};
    auto reached =
        std::find_if(points_.begin(), points_.end(), [error](const CurvePoint &p) { return p.error <= error; });
    if (reached->error == error) return Reading{reached->cost, false};
    const CurvePoint &before = *std::prev(reached);
    return Reading{LogLog(error, before.error, before.cost, reached->error, reached->cost), false};
}

std::vector<CurvePoint> MeanCurve(std::span<const std::vector<CurvePoint>> runs) {
    std::vector<CurvePoint> mean;
    if (runs.empty()) return mean;
    size_t length = runs[0].size();
    for (const auto &run : runs) length = std::min(length, run.size());
    const auto n = static_cast<double>(runs.size());
    for (size_t i = 0; i < length; ++i) {
        CurvePoint p;
        for (const auto &run : runs) {
            p.cost += run[i].cost / n;
            p.error += run[i].error / n;
        }
        mean.push_back(p);
    }
    return mean;
}

std::optional<ErrorCurve::Reading> SpeedUpToEqualError(const ErrorCurve &mine, const ErrorCurve &other) {
    if (mine.Empty() || other.Empty()) return {};
    const CurvePoint &last = mine.Points().back();
    if (auto needed = other.CostToReach(last.error))
        return ErrorCurve::Reading{needed->value / last.cost, needed->extrapolated};
    const CurvePoint &first = other.Points().front();
    auto needed = mine.CostToReach(first.error);
    if (!needed) return {};
    return ErrorCurve::Reading{first.cost / needed->value, needed->extrapolated};
}

std::optional<double> ErrorRatioAtEqualCost(const ErrorCurve &mine, const ErrorCurve &other) {
    if (mine.Empty() || other.Empty()) return {};
    const double cost = std::min(mine.Points().back().cost, other.Points().back().cost);
    auto a = mine.ErrorAt(cost), b = other.ErrorAt(cost);
    if (!a || !b) return {};
    return a->value / b->value;
}

double Efficiency(double error, double seconds) { return error > 0 && seconds > 0 ? 1 / (error * seconds) : 0; }

}  // namespace ext::lab
