#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace saw_ndt::internal {

/// Reads the members of a JSON object and remembers which; what goes wrong is an Error that names file and member.
/// A member that is not there leaves its value as it is.
class MemberReader {
 public:
  /// @param place  of the object in the file: empty for the document itself
  MemberReader(const nlohmann::json& object, std::string file, std::string place);

  /// @throws Error unless the member is there
  void require(const char* name) const;
  void read(const char* name, double& value);
  void read(const char* name, int& value);
  void read(const char* name, bool& value);
  void read(const char* name, std::string& value);
  void read(const char* name, std::vector<double>& values);
  void read(const char* name, std::vector<std::string>& values);
  /// A number, which is both, or [least, greatest].
  void readRange(const char* name, double& least, double& greatest);
  template <typename Element>
  void read(const char* name, Element& element, void (*read_element)(MemberReader&, Element&)) {
    if (const nlohmann::json* member = find(name)) readObject(*member, placeOf(name), element, read_element);
  }
  template <typename Element>
  void read(const char* name, std::vector<Element>& elements, void (*read_element)(MemberReader&, Element&)) {
    const nlohmann::json* member = findList(name);
    if (member == nullptr) return;
    for (const nlohmann::json& item : *member) {
      readObject(item, placeOf(name, elements.size()), elements.emplace_back(), read_element);
    }
  }
  /// @throws Error where a member was not read
  void finish() const;

 private:
  template <typename Element>
  void readObject(const nlohmann::json& object, const std::string& place, Element& element,
                  void (*read_element)(MemberReader&, Element&)) {
    MemberReader reader(object, file_, place);
    read_element(reader, element);
    reader.finish();
  }
  const nlohmann::json* find(const char* name);
  const nlohmann::json* findList(const char* name);
  double number(const nlohmann::json& value, const std::string& place) const;
  std::string text(const nlohmann::json& value, const std::string& place) const;
  std::string placeOf(const std::string& name) const { return place_.empty() ? name : place_ + "." + name; }
  std::string placeOf(const std::string& name, std::size_t index) const {
    return placeOf(name) + "[" + std::to_string(index) + "]";
  }

  const nlohmann::json& object_;
  std::string file_, place_;
  std::set<std::string> read_;
};

}  // namespace saw_ndt::internal
