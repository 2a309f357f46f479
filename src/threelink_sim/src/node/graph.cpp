#include "threelink_sim/node/graph.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>

#include <boost/shared_array.hpp>
#include <netdb.h>
#include <ros/header.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>
#include <xmlrpcpp/XmlRpcClient.h>
#include <xmlrpcpp/XmlRpcDispatch.h>
#include <xmlrpcpp/XmlRpcException.h>

namespace threelink_sim {
namespace {

using XmlRpc::XmlRpcValue;

// Parts of the master's getSystemState.
constexpr int kPublishers = 0, kServices = 2;

// Names in the row of `name` of a part of the system's state.
std::vector<std::string> nodes_of(int part, const std::string& name) {
  XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  std::vector<std::string> nodes;
  if (!ros::master::execute("getSystemState", request, response, payload, false)) return nodes;
  XmlRpcValue& rows = payload[part];
  for (int i = 0; i < rows.size(); ++i) {
    if (static_cast<std::string&>(rows[i][0]) != name) continue;
    for (int j = 0; j < rows[i][1].size(); ++j)
      nodes.push_back(static_cast<std::string&>(rows[i][1][j]));
  }
  return nodes;
}

constexpr std::chrono::milliseconds kPatience(500);  // for each of the two answers

// Where a node serves a topic over TCP; false if it does not say.
bool request_topic(const std::string& node, const std::string& topic, std::string& host,
                   std::uint32_t& port) {
  XmlRpcValue request, response, uri;
  request[0] = ros::this_node::getName();
  request[1] = node;
  if (!ros::master::execute("lookupNode", request, response, uri, false)) return false;
  if (!ros::network::splitURI(static_cast<std::string&>(uri), host, port)) return false;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpcValue wanted, answer;
  wanted[0] = ros::this_node::getName();
  wanted[1] = topic;
  wanted[2][0][0] = std::string("TCPROS");
  if (!client.executeNonBlock("requestTopic", wanted)) return false;
  XmlRpc::XmlRpcDispatch dispatch;
  dispatch.addSource(&client,
                     XmlRpc::XmlRpcDispatch::WritableEvent | XmlRpc::XmlRpcDispatch::Exception);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  bool done = false;
  while (!done && std::chrono::steady_clock::now() < end) {
    dispatch.work(0.05);
    done = client.executeCheckDone(answer);
  }
  dispatch.removeSource(&client);
  if (!done || answer.getType() != XmlRpcValue::TypeArray || answer.size() != 3 ||
      answer[2].getType() != XmlRpcValue::TypeArray || answer[2].size() != 3)
    return false;
  host = static_cast<std::string&>(answer[2][1]);
  port = static_cast<std::uint32_t>(static_cast<int&>(answer[2][2]));
  return true;
}

class Socket {
 public:
  Socket(const std::string& host, std::uint32_t port) {
    addrinfo hints{}, *found = nullptr;
    hints.ai_socktype = SOCK_STREAM;
    if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) return;
    file_ = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const timeval patience{0, std::chrono::microseconds(kPatience).count()};  // of connect(), too
    setsockopt(file_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    setsockopt(file_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    connected_ = connect(file_, found->ai_addr, found->ai_addrlen) == 0;
    freeaddrinfo(found);
  }
  ~Socket() {
    if (file_ >= 0) close(file_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  bool write(const void* data, std::size_t size) {
    return connected_ && send(file_, data, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size);
  }
  bool read(void* data, std::size_t size) {
    return connected_ && recv(file_, data, size, MSG_WAITALL) == static_cast<ssize_t>(size);
  }

 private:
  int file_ = -1;
  bool connected_ = false;
};

}  // namespace

std::vector<std::string> publishers_of(const std::string& topic) {
  return nodes_of(kPublishers, topic);
}

std::vector<std::string> providers_of(const std::string& service) {
  return nodes_of(kServices, service);
}

std::string node_behind(const std::string& service, const std::string& topic) {
  const std::vector<std::string> servers = providers_of(service);
  if (servers.size() != 1) return "";
  const std::vector<std::string> publishers = publishers_of(topic);
  return std::count(publishers.begin(), publishers.end(), servers[0]) > 0 ? servers[0] : "";
}

TopicType type_at_publisher(const std::string& node, const std::string& topic) try {
  std::string host;
  std::uint32_t port = 0;
  if (!request_topic(node, topic, host, port)) return {};
  Socket socket(host, port);
  boost::shared_array<std::uint8_t> hello;
  std::uint32_t size = 0;
  // Under another name: the publisher is not to believe that this node hears it.
  ros::Header::write({{"callerid", ros::this_node::getName() + "_asks_for_the_type"},
                      {"topic", topic},
                      {"type", "*"},
                      {"md5sum", "*"}},
                     hello, size);
  constexpr std::uint32_t kLongest = 1 << 20;  // a header has the message's definition, too
  if (!socket.write(&size, sizeof size) || !socket.write(hello.get(), size) ||
      !socket.read(&size, sizeof size) || size > kLongest)
    return {};
  const boost::shared_array<std::uint8_t> answer(new std::uint8_t[size]);
  if (!socket.read(answer.get(), size)) return {};
  ros::Header header;
  std::string error;
  TopicType type;
  if (!header.parse(answer, size, error) || !header.getValue("type", type.datatype) ||
      !header.getValue("md5sum", type.md5sum))
    return {};
  return type;
} catch (const XmlRpc::XmlRpcException&) {  // an answer of another form
  return {};
}

}  // namespace threelink_sim
