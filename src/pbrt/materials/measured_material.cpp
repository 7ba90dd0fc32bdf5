#include "pbrt/materials/measured_material.h"

#include <fmt/format.h>

#include <algorithm>

#include "pbrt/core/error.h"
#include "pbrt/materials/tensor_file.h"

namespace pbrt {

namespace {

using Shape = std::vector<size_t>;

class Reader {
  public:
    explicit Reader(const std::string &path) : path_(path), file_(TensorFile::Read(path)) {}

    std::vector<Float> Axis(const std::string &name) const {
        std::vector<Float> values = file_.Get(name, 1).values;
        for (size_t i = 1; i < values.size(); ++i)
            if (!(values[i] > values[i - 1])) Fail(name, "must increase");
        return values;
    }
    /// The leading dimensions must be `slices`; the last two are rows and columns.
    GridSlices Grid(const std::string &name, const Shape &slices) const {
        const TensorFile::Field &field = file_.Get(name, slices.size() + 2);
        if (!std::equal(slices.begin(), slices.end(), field.shape.begin()))
            Fail(name, "does not fit the numbers of directions and wavelengths");
        const size_t rows = field.shape[slices.size()], columns = field.shape[slices.size() + 1];
        if (rows < 2 || columns < 2) Fail(name, "needs two rows and columns at least");
        for (Float v : field.values)
            if (!std::isfinite(v)) Fail(name, "holds a value that is not finite");
        return {field.values, static_cast<int>(columns), static_cast<int>(rows)};
    }
    GridSlices Density(const std::string &name, const Shape &slices) const {
        GridSlices grid = Grid(name, slices);
        for (size_t s = 0; s < grid.Count(); ++s) {
            Float most = 0;
            for (int y = 0; y < grid.Ny(); ++y)
                for (int x = 0; x < grid.Nx(); ++x) {
                    if (grid.At(s, x, y) < 0) Fail(name, "holds a negative value");
                    most = std::max(most, grid.At(s, x, y));
                }
            if (!(most > 0)) Fail(name, "is 0 everywhere for some direction");
        }
        return grid;
    }
    [[noreturn]] void Fail(const std::string &name, const char *why) const {
        throw UserError(fmt::format("{}: field \"{}\" {}.", path_, name, why));
    }

  private:
    const std::string &path_;
    TensorFile file_;
};

}  // namespace

std::shared_ptr<const MeasuredBrdf> ReadMeasuredBrdf(const std::string &path) {
    const Reader read(path);
    MeasuredBrdf::Tables t;
    t.phi = read.Axis("phi_i");
    t.theta = read.Axis("theta_i");
    t.wavelengths = read.Axis("wavelengths");
    if (t.phi.size() > 2 && std::round(2 * Pi / (t.phi.back() - t.phi.front())) != 1)
        read.Fail("phi_i", "covers a part of the circle only; such reduced tables are not supported");
    t.ndf = read.Grid("ndf", {});
    t.sigma = read.Grid("sigma", {});
    t.visibleNormals = read.Density("vndf", {t.phi.size(), t.theta.size()});
    t.luminance = read.Density("luminance", {t.phi.size(), t.theta.size()});
    t.spectra = read.Grid("spectra", {t.phi.size(), t.theta.size(), t.wavelengths.size()});
    return std::make_shared<const MeasuredBrdf>(std::move(t));
}

}  // namespace pbrt
