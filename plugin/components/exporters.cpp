// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "formats/line_file.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_export.hpp"
#include "hexaplast/formats/whole_file.hpp"
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
  /// Where files of that name go; rejects a name to which nothing may be written.
  fs::path claim(const fs::path& name, bool is_series) {
    try {
      return node().files().claim(name, is_series);
    } catch (const scene::OutputRefusal& refusal) {
      reject("filename", refusal.what(), refusal.hint(), refusal.fault());
    } catch (const OutputError& error) {
      reject("filename", error.what());
    } catch (const fs::filesystem_error& error) {
      reject("filename", reason_of(error));
    }
  }

  static std::string reason_of(const fs::filesystem_error& error) {
    return fmt::format("{}: {}", error.path1().string(), error.code().message());
  }

  bool writes() const { return node().files().rules.writes; }

  /// Turns what goes wrong with a file into an error of the scene's.
  template <class Write>
  void attempt(const Write& write) {
    try {
      write();
    } catch (const OutputError& error) {
      throw scene::FileError(scene::format_error(place(), fmt::format("{}: {}", class_name(), error.what())));
    } catch (const fs::filesystem_error& error) {
      throw scene::FileError(scene::format_error(place(), fmt::format("{}: {}", class_name(), reason_of(error))));
    }
  }
};

class VTKExporter final : public Exporter {
 public:
  VTKExporter() : Exporter(attributes::kVTKExporter) {}

  void bwd_init() override {
    fs::path name = text("filename").empty() ? this->name() : text("filename");
    if (name.extension() == ".vtu") name.replace_extension();
    is_series_ = !boolean("overwrite");
    if (!is_series_) name += ".vtu";
    const bool is_enabled = boolean("enable");
    is_on_ = is_enabled && (boolean("exportAtBegin") || integer("exportEveryNumberOfSteps") > 0);
    if (is_enabled && !is_on_)
      remark(scene::Severity::kWarning, "",
             "writes nothing: neither exportEveryNumberOfSteps nor exportAtBegin is given");
    if (is_on_) place_ = claim(name, is_series_);
    collect(field_sources_.points, "pointsDataFields");
    collect(field_sources_.cells, "cellsDataFields");
    reset();
  }
  void begin_step() override {
    if (!is_on_ || !writes()) return;
    if (!has_begun_ && is_series_) attempt([&] { node().files().begin_series(place_, num_files_); });
    has_begun_ = true;
    if (boolean("exportAtBegin") && num_steps_ == 0 && num_files_ == 0) write();
  }
  void end_step(double) override {
    const int every = integer("exportEveryNumberOfSteps");
    if (!is_on_ || every == 0) return;
    ++num_steps_;
    if (num_steps_ % every == 0) write();
  }
  void reset() override {
    num_steps_ = num_files_ = 0;
    has_begun_ = false;
  }
  void serialize(Archive& archive) override {
    archive(num_steps_, num_files_);
    if (archive.reads()) has_begun_ = false;
  }

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
      if (state && state->num_nodes() == num_points) surviving.emplace(*state);
    }

    template <std::size_t N>
    std::span<const std::array<int, N>> left_of(const std::vector<std::array<int, N>>& all,
                                                std::vector<std::array<int, N>>& left) {
      for (const std::array<int, N>& cell : all) {
        if (const int node = std::ranges::max(cell); node >= num_points)
          owner.reject(fmt::format("a cell of its topology has node {}, there are {} points", node, num_points));
        is_left.push_back(!surviving || surviving->has(cell));
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
    std::optional<scene::SurvivingCells> surviving;
    std::vector<bool> is_left;  // of all cells, one kind after the other
    std::vector<Edge> edges;
    std::vector<Triangle> triangles;
    std::vector<Quad> quads;
    std::vector<Hexahedron> hexahedra;
    std::vector<std::vector<double>> values;  // of each field
  };

  fs::path file() const {
    if (!is_series_) return place_;
    return fs::path(place_) += std::to_string(num_files_) + ".vtu";
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
    if (!writes()) return;
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

    attempt([&] {
      node().files().prepare(file());
      WholeFile out(file());
      out.write(vtu_text(mesh));
      out.commit();
    });
    ++num_files_;
  }

  struct {
    std::vector<Source> points, cells;
  } field_sources_;
  fs::path place_;  // of the file, or of the series
  bool is_series_ = true;
  bool is_on_ = false;      // it writes anything at all
  bool has_begun_ = false;  // what an earlier run has left of the series is gone
  int num_steps_ = 0, num_files_ = 0;
};

class WriteState final : public Exporter {
 public:
  WriteState() : Exporter(attributes::kWriteState) {}

  void init() override {
    const fs::path name = text("filename");
    if (name.empty()) reject("filename", "is not given, must name a file");
    if (name.extension() == ".gz") reject("filename", "ends in .gz: compressed files are not written here");
    state_ = &needed_ready<scene::MechanicalState>();
    times_ = reals("time");
    period_ = real_if_given("period");
    if (period_ && times_.size() > 1)
      reject("time", fmt::format("{} times given together with a period, must be one", times_.size()));
    if (times_.empty()) {
      times_ = {0};
      if (!period_) period_ = node().clock().dt;
    }
  }

  void bwd_init() override { place_ = claim(text("filename"), false); }

  void begin_step() override {
    if (!writes()) return;
    if (is_to_cut_) attempt([&] { file_->cut(); });
    is_to_cut_ = false;
    if (is_due(node().clock().time, node().clock().dt)) attempt([&] { write(node().clock().time); });
  }
  void reset() override {
    next_ = 0;
    latest_ = 0;
    is_to_cut_ = false;
    file_.reset();  // the next state begins the file anew
  }
  void serialize(Archive& archive) override {
    bool is_begun = file_.has_value();
    archive(next_, latest_, is_begun);
    if (!archive.reads()) {
      if (file_) file_->save(archive);
      return;
    }
    file_.reset();
    is_to_cut_ = is_begun && writes();
    if (is_to_cut_) {
      attempt([&] {
        node().files().prepare(place_);
        file_.emplace(place_, archive);
      });
    } else if (is_begun) {
      archive.take(archive.rest());  // what another host has written does not matter here
    }
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

  void begin() {
    node().files().prepare(place_);
    std::error_code failure;
    fs::remove(place_, failure);  // not emptied: other names of that file keep it
    file_.emplace(place_);
  }

  void write(double time) {
    if (!file_) begin();
    std::string lines = fmt::format("T= {}", time);
    const auto add = [&](const char* name, const PointArray& field) {
      lines += fmt::format("\n  {}= {}", name, fmt::join(field.data(), field.data() + field.size(), " "));
    };
    if (boolean("writeX")) add("X", state_->positions());
    if (boolean("writeX0")) add("X0", state_->rest_positions());
    if (boolean("writeV")) add("V", state_->velocities());
    file_->append(lines);
  }

  fs::path place_;
  std::optional<LineFile> file_;  // absent: not begun
  bool is_to_cut_ = false;        // a checkpoint knows of fewer lines
  scene::MechanicalState* state_ = nullptr;
  std::vector<double> times_;     // [s]
  std::optional<double> period_;  // [s]
  std::size_t next_ = 0;          // of times_
  double latest_ = 0;             // [s] time that was met last
};

}  // namespace

void add_exporters(scene::Factory& factory) {
  factory.add<VTKExporter>(attributes::kVTKExporter);
  factory.add<WriteState>(attributes::kWriteState);
}

}  // namespace hexaplast::components
