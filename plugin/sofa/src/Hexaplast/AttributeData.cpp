// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/AttributeData.h>
#include <fmt/format.h>
#include <sofa/core/topology/TopologyData.h>

#include <algorithm>
#include <stdexcept>
#include <type_traits>

#include "hexaplast/base/error.hpp"
#include "scene/diagnostics.hpp"

namespace hexaplast::sofa_plugin
{
namespace
{

using attributes::Access;
using attributes::Attribute;
using attributes::Type;
using sofa::Index;
using sofa::core::BaseData;
using sofa::core::objectmodel::Data;
using sofa::type::Vec3;
using sofa::type::vector;

// How a value of the table lies in a Data of SOFA, and back.
void assign(bool& to, const scene::Value& from) { to = std::get<bool>(from); }
void assign(int& to, const scene::Value& from) { to = static_cast<int>(std::get<std::int64_t>(from)); }
void assign(SReal& to, const scene::Value& from) { to = std::get<double>(from); }
void assign(std::string& to, const scene::Value& from) { to = std::get<std::string>(from); }
void assign(vector<Index>& to, const scene::Value& from)
{
    const auto& numbers = std::get<std::vector<std::int64_t>>(from);
    to.assign(numbers.begin(), numbers.end());
}
void assign(vector<SReal>& to, const scene::Value& from)
{
    const auto& numbers = std::get<std::vector<double>>(from);
    to.assign(numbers.begin(), numbers.end());
}
void assign(Vec3& to, const scene::Value& from)
{
    const auto& numbers = std::get<std::vector<double>>(from);
    std::copy_n(numbers.begin(), std::min<std::size_t>(3, numbers.size()), to.ptr());
}
void assign(vector<Vec3>& to, const scene::Value& from)
{
    const auto& numbers = std::get<std::vector<double>>(from);
    to.resize(numbers.size() / 3);
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = Vec3(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]);
}

scene::Value value_of(bool from) { return from; }
scene::Value value_of(int from) { return std::int64_t{from}; }
scene::Value value_of(SReal from) { return double{from}; }
scene::Value value_of(const std::string& from) { return from; }
scene::Value value_of(const vector<Index>& from) { return std::vector<std::int64_t>(from.begin(), from.end()); }
scene::Value value_of(const vector<SReal>& from) { return std::vector<double>(from.begin(), from.end()); }
scene::Value value_of(const Vec3& from) { return std::vector<double>(from.begin(), from.end()); }
scene::Value value_of(const vector<Vec3>& from)
{
    std::vector<double> numbers;
    for (const Vec3& v : from) numbers.insert(numbers.end(), v.begin(), v.end());
    return numbers;
}

/// Calls with a null pointer to the C++ type that an attribute has in SOFA.
template <class Call>
void with_type(const Attribute& attribute, const Call& call)
{
    switch (attribute.type)
    {
        case Type::kBool:
            return call(static_cast<bool*>(nullptr));
        case Type::kInteger:
            return call(static_cast<int*>(nullptr));
        case Type::kReal:
            return call(static_cast<SReal*>(nullptr));
        case Type::kVector3:
            return call(static_cast<Vec3*>(nullptr));
        case Type::kIntegers:
            return call(static_cast<vector<Index>*>(nullptr));
        case Type::kReals:
            return call(static_cast<vector<SReal>*>(nullptr));
        case Type::kVectors3:
            return call(static_cast<vector<Vec3>*>(nullptr));
        case Type::kText:
        case Type::kWord:
            return call(static_cast<std::string*>(nullptr));
        case Type::kBoxes:
        case Type::kHexahedra:
        case Type::kLink:
            break;
    }
    throw std::logic_error(fmt::format("attribute {} has a type that the SOFA plugin does not know", attribute.name));
}

std::string help_of(const Attribute& attribute)
{
    std::string help(attribute.help);
    if (!attribute.words.empty()) help += fmt::format(" One of: {}.", attribute.words);
    if (!attribute.unit.empty()) help += fmt::format(" [{}]", attribute.unit);
    return help;
}

}  // namespace

scene::Place place_of(const SofaComponent& component)
{
    const std::string& file = component.getDefinitionSourceFileName();
    if (file.empty()) return {component.getPathName(), 0};
    return {file, component.getDefinitionSourceFilePos()};
}

AttributeData::AttributeData(SofaComponent& owner, const attributes::Description& description) : m_owner(owner)
{
    for (const Attribute& attribute : description.attributes)
    {
        if (attribute.type == Type::kLink) continue;
        Entry entry{.attribute = &attribute, .data = owner.findData(std::string(attribute.name))};
        if (!entry.data)
        {
            with_type(attribute,
                      [&](auto* type)
                      {
                          using T = std::remove_pointer_t<decltype(type)>;
                          auto data =
                              std::make_unique<Data<T>>(help_of(attribute), true, attribute.access == Access::kOutput);
                          if (!attribute.initial.empty())
                          {
                              T initial{};
                              assign(initial, scene::read_value(attribute, attribute.initial));
                              data->setValue(initial);
                              data->unset();
                          }
                          entry.data = data.get();
                          entry.own = std::move(data);
                      });
            entry.data->setGroup(attribute.access == Access::kOutput ? "Outputs" : "");
            owner.addData(entry.data, std::string(attribute.name));
            for (const std::string_view alias : scene::split_words(attribute.aliases))
                owner.addAlias(entry.data, std::string(alias).c_str());
        }
        m_entries.push_back(std::move(entry));
    }
}

AttributeData::~AttributeData() = default;

void AttributeData::give_all_to(scene::Object& guest)
{
    for (Entry& entry : m_entries) entry.given = -1;
    give_to(guest);
}

void AttributeData::give_to(scene::Object& guest)
{
    const scene::Place place = place_of(m_owner);
    scene::Diagnostics diagnostics;
    for (Entry& entry : m_entries)
    {
        if (entry.attribute->access == Access::kOutput || !entry.data->isSet()) continue;
        with_type(*entry.attribute,
                  [&](auto* type)
                  {
                      using T = std::remove_pointer_t<decltype(type)>;
                      const auto* data = dynamic_cast<const Data<T>*>(entry.data);
                      if (!data)
                          throw std::logic_error(
                              fmt::format("Data {} of SOFA has another type than here", entry.attribute->name));
                      const T& value =
                          data->getValue();  // brings the counter up to date where the Data follows another
                      if (entry.given == data->getCounter()) return;
                      try
                      {
                          guest.find_data(entry.attribute->name)->give(value_of(value), place);
                          entry.given = data->getCounter();
                      }
                      catch (const InputError& error)
                      {
                          diagnostics.error(
                              place, fmt::format("{}.{}: {}", guest.class_name(), entry.attribute->name, error.what()));
                      }
                  });
    }
    diagnostics.throw_errors();
}

void AttributeData::fetch_from(scene::Object& guest)
{
    for (Entry& entry : m_entries)
    {
        if (entry.attribute->access != Access::kOutput) continue;
        const scene::Value& value = guest.find_data(entry.attribute->name)->value();
        if (std::holds_alternative<std::monostate>(value)) continue;
        with_type(*entry.attribute,
                  [&](auto* type)
                  {
                      using T = std::remove_pointer_t<decltype(type)>;
                      if (auto* data = dynamic_cast<Data<T>*>(entry.data))
                      {
                          assign(*data->beginWriteOnly(), value);
                          data->endEdit();
                      }
                  });
    }
}

std::vector<BaseData*> AttributeData::outputs() const
{
    std::vector<BaseData*> found;
    for (const Entry& entry : m_entries)
        if (entry.attribute->access == Access::kOutput) found.push_back(entry.data);
    return found;
}

}  // namespace hexaplast::sofa_plugin
