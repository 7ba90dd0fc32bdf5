#include <bit>
#include <cstring>

#include "pbrt/core/files.h"
#include "pbrt/core/state_io.h"
#include "pbrt/materials/material_params.h"

namespace pbrt {
namespace {

static_assert(std::endian::native == std::endian::little);

using Shape = std::vector<size_t>;

struct Field {
    std::string name;
    Shape shape;
    std::vector<Float> values;  ///< empty if the type is not float32 (others are unused)
};

constexpr uint8_t kFloat32 = 10;

/// Named arrays of a little-endian file, the container of the RGL material database.
std::vector<Field> ReadTensorFile(const std::string &path) {
    constexpr std::string_view head("tensor_file\0", 12);
    const std::string data = ReadFileContents(path);
    StateReader in(data, path + ": tensor file");
    in.Require(data.starts_with(head), "its header is missing");
    in.Take(head.size());
    const int major = in.Value<uint8_t>(), minor = in.Value<uint8_t>();
    if (major != 1 || minor != 0) throw UserError("{}: tensor file has an unknown version (1.0 is known).", path);
    std::vector<Field> fields;
    const uint32_t count = in.Value<uint32_t>();
    uint64_t total = 0;
    for (uint32_t i = 0; i < count; ++i) {
        Field field;
        field.name = in.Take(in.Value<uint16_t>());
        const size_t dimensions = in.Value<uint16_t>();
        const uint8_t type = in.Value<uint8_t>();
        const uint64_t offset = in.Value<uint64_t>();
        uint64_t size = 1;
        for (size_t d = 0; d < dimensions; ++d) {
            const uint64_t extent = in.Value<uint64_t>();
            in.Require(extent == 0 || (extent <= data.size() && size <= data.size() / extent), "it is cut off");
            size *= extent;
            field.shape.push_back(extent);
        }
        if (type == kFloat32) {
            total += size;
            in.Require(total <= data.size() / sizeof(float), "it has fields that overlap");
            StateReader at(data, in.What());
            at.Take(offset);
            const std::string_view values = at.Take(size * sizeof(float));
            field.values.resize(size);
            if (size > 0) std::memcpy(field.values.data(), values.data(), values.size());
        }
        fields.push_back(std::move(field));
    }
    return fields;
}

class Reader {
  public:
    explicit Reader(const std::string &path) : path_(path), fields_(ReadTensorFile(path)) {}

    std::vector<Float> Axis(const std::string &name) const {
        std::vector<Float> values = Get(name, 1).values;
        for (size_t i = 1; i < values.size(); ++i)
            if (!(values[i] > values[i - 1])) Fail(name, "must increase");
        return values;
    }
    /// The leading dimensions must be `slices`; the last two are rows and columns.
    GridSlices Grid(const std::string &name, const Shape &slices) const {
        const Field &field = Get(name, slices.size() + 2);
        if (!std::equal(slices.begin(), slices.end(), field.shape.begin()))
            Fail(name, "does not fit the numbers of directions and wavelengths");
        const size_t rows = field.shape[slices.size()], columns = field.shape[slices.size() + 1];
        if (rows < 2 || columns < 2) Fail(name, "needs two rows and columns at least");
        return {field.values, int(columns), int(rows)};
    }
    GridSlices Density(const std::string &name, const Shape &slices) const {
        GridSlices grid = Grid(name, slices);
        const std::vector<Float> &values = Get(name, slices.size() + 2).values;
        const size_t perSlice = values.size() / grid.Count();
        for (auto slice = values.begin(); slice != values.end(); slice += perSlice) {
            const auto [min, max] = std::minmax_element(slice, slice + perSlice);
            if (*min < 0) Fail(name, "holds a negative value");
            if (!(*max > 0)) Fail(name, "is 0 everywhere, or for some direction");
        }
        return grid;
    }
    [[noreturn]] void Fail(const std::string &name, const char *why) const {
        throw UserError("{}: field \"{}\" {}.", path_, name, why);
    }

  private:
    /// Throws UserError if the field is missing, not float32, not finite, or of another dimension count.
    const Field &Get(const std::string &name, size_t dimensions) const {
        const auto field = std::ranges::find(fields_, name, &Field::name);
        if (field == fields_.end()) Fail(name, "is missing");
        if (field->shape.size() != dimensions || field->values.empty())
            Fail(name, fmt::format("must be 32 bit floats in {} dimensions", dimensions).c_str());
        for (size_t i = 0; i < field->values.size(); ++i)
            if (!std::isfinite(field->values[i]))
                throw UserError("{}: field \"{}\": value {} is {}; all must be finite.", path_, name, i,
                                field->values[i]);
        return *field;
    }

    const std::string &path_;
    std::vector<Field> fields_;
};

struct MeasuredParams : ReliefParams {
    std::string filename;
    void Describe(auto &&v) {
        v("filename", filename, Required(), "file of the RGL database");
        ReliefParams::Describe(v);
    }
};

}  // namespace

std::shared_ptr<const MeasuredBrdf> ReadMeasuredBrdf(const std::string &path) {
    const Reader read(path);
    MeasuredBrdf::Tables t;
    t.phi = read.Axis("phi_i");
    t.theta = read.Axis("theta_i");
    t.wavelengths = read.Axis("wavelengths");
    if (t.theta.front() < -0.01f || t.theta.back() > 1.58f) read.Fail("theta_i", "must hold angles from 0 to Pi / 2");
    if (t.wavelengths.front() > LambdaMax || t.wavelengths.back() < LambdaMin)
        read.Fail("wavelengths", "holds none from 360 to 830 nm");
    if (t.phi.size() > 2 && std::round(2 * Pi / (t.phi.back() - t.phi.front())) != 1)
        read.Fail("phi_i", "covers a part of the circle only; such reduced tables are not supported");
    if (t.phi.size() > 2 && std::abs(t.phi.front() + t.phi.back()) > 1) read.Fail("phi_i", "must go from -Pi to Pi");
    t.ndf = read.Density("ndf", {});
    t.sigma = read.Density("sigma", {});
    t.visibleNormals = read.Density("vndf", {t.phi.size(), t.theta.size()});
    t.luminance = read.Density("luminance", {t.phi.size(), t.theta.size()});
    t.spectra = read.Grid("spectra", {t.phi.size(), t.theta.size(), t.wavelengths.size()});
    return std::make_shared<const MeasuredBrdf>(std::move(t));
}

void AddMeasured(MaterialTable &table) {
    AddSurface<MeasuredParams>(
        table, "measured",
        "isotropic, or anisotropic over the whole circle; else **not supported**: `field \"phi_i\" covers a part "
        "of the circle only; such reduced tables are not supported.` The databases cannot be shipped, so tests "
        "write their own files",
        [](const auto &p, const ParamSet &set, MaterialContext &c) {
            auto brdf = set.At("filename", [&] { return ReadMeasuredBrdf(c.files.Resolve(p.filename)); });
            return MakeLobeMaterial([brdf](const SurfacePoint &, auto &lambda) { return MeasuredBxdf(*brdf, lambda); });
        });
}

}  // namespace pbrt
