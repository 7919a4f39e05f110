// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/file_export.hpp"
#include "scene/interfaces.hpp"
#include "scene/links.hpp"
#include "scene/reader.hpp"

namespace hexaplast::components {
namespace {

namespace fs = std::filesystem;

/// What components that write files have in common.
class Exporter : public scene::Component {
 public:
  using Component::Component;
  void refresh() override {}  // files hold what there is when they are written

 protected:
  /// Rejects a place where no file can be.
  void check_place(const fs::path& file) {
    const fs::path folder = file.parent_path();
    if (!folder.empty() && !fs::is_directory(folder))
      reject("filename", fmt::format("'{}' is no directory", folder.string()));
    if (fs::exists(file) && !fs::is_regular_file(file))
      reject("filename", fmt::format("'{}' is not a file", file.string()));
  }

  [[noreturn]] void fail(const fs::path& file) {
    throw scene::FileError(
        scene::format_error(place(), fmt::format("{}: '{}' cannot be written", class_name(), file.string())));
  }
};

class VTKExporter final : public Exporter {
 public:
  VTKExporter() : Exporter(attributes::kVTKExporter) {}

  void bwd_init() override {
    check_place(file());
    collect(field_sources_.points, "pointsDataFields");
    collect(field_sources_.cells, "cellsDataFields");
    num_steps_ = num_files_ = 0;
  }
  void begin_step() override {
    if (boolean("enable") && boolean("exportAtBegin") && num_steps_ == 0 && num_files_ == 0) write();
  }
  void end_step(double) override {
    const int every = integer("exportEveryNumberOfSteps");
    if (!boolean("enable") || every == 0) return;
    ++num_steps_;
    if (num_steps_ % every == 0) write();
  }
  void serialize(Archive& archive) override { archive(num_steps_, num_files_); }

 private:
  struct Source {
    std::string name;
    scene::Object* object;
    std::string attribute;
  };

  /// The cells of a topology that have not gone with torn hexahedra, and their numbers of the fields.
  struct Cells {
    Cells(VTKExporter& exporter, int points) : owner(exporter), num_points(points) {
      scene::MechanicalState* state = owner.node().nearest<scene::MechanicalState>();
      if (state && state->num_nodes() == num_points) remains.emplace(*state);
    }

    template <std::size_t N>
    std::span<const std::array<int, N>> left_of(const std::vector<std::array<int, N>>& all,
                                                std::vector<std::array<int, N>>& left) {
      for (const std::array<int, N>& cell : all) {
        if (const int node = std::ranges::max(cell); node >= num_points)
          owner.reject(fmt::format("a cell of its topology has node {}, there are {} points", node, num_points));
        is_left.push_back(!remains || remains->has(cell));
        if (is_left.back()) left.push_back(cell);
      }
      return left;
    }

    void leave_out(std::vector<ExportedField>& fields) {
      values.reserve(fields.size());  // the fields look into it
      for (ExportedField& field : fields) {
        std::vector<double>& left = values.emplace_back();
        const auto size = static_cast<std::size_t>(field.components);
        for (std::size_t i = 0; i < is_left.size(); ++i)
          if (is_left[i]) left.insert(left.end(), &field.values[i * size], &field.values[i * size] + size);
        field.values = left;
      }
    }

    VTKExporter& owner;
    int num_points;
    std::optional<scene::Remains> remains;
    std::vector<bool> is_left;  // of all cells, one kind after the other
    std::vector<Edge> edges;
    std::vector<Triangle> triangles;
    std::vector<Quad> quads;
    std::vector<Hexahedron> hexahedra;
    std::vector<std::vector<double>> values;  // of each field
  };

  fs::path file() {
    fs::path path = text("filename").empty() ? name() : text("filename");
    if (path.extension() == ".vtu") path.replace_extension();
    if (!boolean("overwrite")) path += std::to_string(num_files_);
    path += ".vtu";
    return path;
  }

  // Words of the form [name=]path.attribute.
  void collect(std::vector<Source>& sources, std::string_view list) {
    sources.clear();
    for (const std::string_view word : scene::split_words(text(list))) {
      const std::size_t equals = word.find('=');
      const std::string_view path = equals == word.npos ? word : word.substr(equals + 1);
      const std::size_t dot = path.rfind('.');
      if (dot == path.npos || dot == 0) reject(list, fmt::format("'{}' must be [name=]path.attribute", word));

      const scene::PathResult found = scene::resolve_path(node(), this, path.substr(0, dot));
      if (!found.target) reject(list, fmt::format("'{}' {}", word, found.problem), found.hint);
      const std::string attribute(path.substr(dot + 1));
      const scene::Data* data = found.target->find_data(attribute);
      if (!data)
        reject(list, fmt::format("'{}': {} has no attribute '{}'", word, found.target->class_name(), attribute));
      using attributes::Type;
      const Type type = data->attribute().type;
      if (type != Type::kReals && type != Type::kVectors3)
        reject(list, fmt::format("'{}' holds no list of real numbers", word));
      const std::string_view name =
          equals == word.npos ? std::string_view(data->attribute().name) : word.substr(0, equals);
      sources.push_back({std::string(name), found.target, std::string(data->attribute().name)});
    }
  }

  std::vector<ExportedField> fields(const std::vector<Source>& sources, std::string_view list, std::size_t count) {
    std::vector<ExportedField> all;
    for (const Source& source : sources) {
      const std::vector<double>& values = source.object->reals(source.attribute);
      if (values.size() != count && values.size() != 3 * count)
        reject(list,
               fmt::format("'{}' has {} numbers, must have {} or {}", source.name, values.size(), count, 3 * count));
      all.push_back({source.name, values.size() == count ? 1 : 3, values});
    }
    return all;
  }

  void write() {
    std::vector<double> own_points;
    if (is_given("position")) {
      own_points = reals("position");
    } else {
      const PointArray& x = needed_ready<scene::MechanicalState>().positions();
      own_points.assign(x.data(), x.data() + x.size());
    }
    scene::Topology& topology = needed<scene::Topology>();
    Cells cells(*this, static_cast<int>(own_points.size() / 3));
    ExportedMesh mesh{.points = own_points};
    if (boolean("edges")) mesh.edges = cells.left_of(topology.edges(), cells.edges);
    if (boolean("triangles")) mesh.triangles = cells.left_of(topology.triangles(), cells.triangles);
    if (boolean("quads")) mesh.quads = cells.left_of(topology.quads(), cells.quads);
    if (boolean("hexas")) mesh.hexahedra = cells.left_of(topology.hexahedra(), cells.hexahedra);
    mesh.point_fields = fields(field_sources_.points, "pointsDataFields", own_points.size() / 3);
    mesh.cell_fields = fields(field_sources_.cells, "cellsDataFields", cells.is_left.size());
    cells.leave_out(mesh.cell_fields);

    // whole under its own name, or not at all
    const fs::path whole = file(), part = whole.string() + ".part";
    std::ofstream stream(part, std::ios::binary);
    stream << vtu_text(mesh);
    stream.close();
    std::error_code failure;
    if (stream) fs::rename(part, whole, failure);
    if (!stream || failure) fail(whole);
    ++num_files_;
  }

  struct {
    std::vector<Source> points, cells;
  } field_sources_;
  int num_steps_ = 0, num_files_ = 0;
};

class WriteState final : public Exporter {
 public:
  WriteState() : Exporter(attributes::kWriteState) {}

  void init() override {
    file_ = text("filename");
    if (file_.empty()) reject("filename", "is not given, must name a file");
    if (file_.extension() == ".gz") reject("filename", "ends in .gz: compressed files are not written here");
    check_place(file_);
    state_ = &needed_ready<scene::MechanicalState>();
    times_ = reals("time");
    period_ = real_if_given("period");
    if (period_ && times_.size() > 1)
      reject("time", fmt::format("{} times given beside a period, must be one", times_.size()));
    if (times_.empty()) {
      times_ = {0};
      if (!period_) period_ = node().clock().dt;
    }
  }

  void begin_step() override {
    if (is_due(node().clock().time, node().clock().dt)) write(node().clock().time);
  }
  void reset() override {
    next_ = 0;
    latest_ = 0;
  }
  void serialize(Archive& archive) override {
    archive(next_, latest_, size_);
    if (archive.reads() && size_ > 0) go_on();
  }

 private:
  // Times are met within a tenth of a step.
  bool is_due(double time, double dt) {
    const bool is_listed = next_ < times_.size();
    if (!is_listed && !period_) return false;
    const double wanted = is_listed ? times_[next_] : latest_ + *period_;
    if (time < wanted && std::abs(time - wanted) >= 0.1 * dt) return false;
    latest_ = wanted;
    next_ += is_listed;
    return true;
  }

  /// Cuts off what was written after the checkpoint.
  void go_on() {
    std::error_code failure;
    const std::uintmax_t present = fs::file_size(file_, failure);
    if (failure || present < size_)
      throw InputError(fmt::format("'{}' has not the {} bytes that the checkpoint knows of", file_.string(), size_));
    stream_.close();
    fs::resize_file(file_, size_, failure);
    if (!failure) stream_.open(file_, std::ios::binary | std::ios::app);
    if (failure || !stream_) fail(file_);
  }

  void write(double time) {
    if (!stream_.is_open()) stream_.open(file_, std::ios::binary);
    fmt::print(stream_, "T= {}\n", time);
    if (boolean("writeX")) write("X", state_->positions());
    if (boolean("writeX0")) write("X0", state_->rest_positions());
    if (boolean("writeV")) write("V", state_->velocities());
    if (!stream_.flush()) fail(file_);
    size_ = static_cast<std::uint64_t>(stream_.tellp());
  }
  void write(const char* name, const PointArray& field) {
    fmt::print(stream_, "  {}= {}\n", name, fmt::join(field.data(), field.data() + field.size(), " "));
  }

  fs::path file_;
  scene::MechanicalState* state_ = nullptr;
  std::vector<double> times_;     // [s]
  std::optional<double> period_;  // [s]
  std::size_t next_ = 0;          // of times_
  double latest_ = 0;             // [s] time that was met last
  std::uint64_t size_ = 0;        // [byte] of the file
  std::ofstream stream_;
};

}  // namespace

void add_exporters(scene::Factory& factory) {
  factory.add<VTKExporter>(attributes::kVTKExporter);
  factory.add<WriteState>(attributes::kWriteState);
}

}  // namespace hexaplast::components
