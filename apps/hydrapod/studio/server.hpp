#pragma once
/// HTTP and WebSocket for one page of this computer: who is let in, and how much anybody may take.
///
/// Every address begins with the key: `/KEY/…`. A request is answered only
///
/// - for a host that is a number (127.0.0.1, [::1]) or localhost, with the port of this server: a
///   name of another domain that was pointed here (DNS rebinding) is refused;
/// - from this origin, or from no page at all (`Origin`, `Sec-Fetch-Site`);
/// - with the key, which is compared in constant time.
///
/// Whoever has not shown the key gets no more than a status, and 10 s. Where there are more
/// connections than `most_connections`, the oldest without the key is closed. Files are not served:
/// what a path means is for the Site, which knows a list of names.
///
/// One thread: everything runs in the io_context that is given.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>

namespace boost::asio {
class io_context;
}

namespace hydrapod::studio {

struct Request {
  bool posts{};        ///< POST, else GET
  std::string path{};  ///< behind the key: "", "state"
  std::string query{};
  std::string body{};
};

struct Response {
  unsigned status{200};
  std::string body{};
  std::string type{"application/json"};
};

/// What the server shows.
class Site {
 public:
  Site() = default;
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;
  virtual ~Site() = default;

  /// May throw: base::InputError becomes 422, anything else 500, with the message.
  virtual Response answer(const Request& request) = 0;
  /// Where the body of this request goes instead of into memory; a response where it is refused;
  /// an empty text where it is no upload.
  virtual std::variant<std::string, Response> upload_place(const Request& head) = 0;
  /// The body is at `place` now.
  virtual Response uploaded(const Request& head, const std::string& place) = 0;
  /// It came only in part; the file is there.
  virtual void upload_failed(const std::string& place) = 0;
  /// What a page gets first when it listens.
  virtual std::string greeting() = 0;
};

struct ServerLimits {
  std::size_t header{16U << 10U};      ///< bytes of request line and header
  std::size_t body{1U << 20U};         ///< bytes of a request that is no upload
  std::uint64_t upload{1ULL << 30U};   ///< bytes
  std::size_t connections{96};         ///< beyond, the oldest without the key is closed
  std::size_t listeners{32};           ///< pages that listen
  std::size_t waiting{4U << 20U};      ///< bytes that a page may leave unread before it is closed
  int header_seconds{10};              ///< until a request with its header has come
  int idle_seconds{30};                ///< between two requests of a connection that had the key
  int body_seconds{10};                ///< until its body has come
  int upload_seconds{600};             ///< the same of an upload
  int write_seconds{60};               ///< until an answer has been taken
};

struct ServerOptions {
  std::string address{"127.0.0.1"};  ///< number of an interface
  std::uint16_t port{};              ///< 0: any that is free
  std::string key{};                 ///< letters, digits, - and _
  ServerLimits limits{};
};

class Server {
 public:
  /// Listens from now on. Throws base::InputError where it cannot.
  Server(boost::asio::io_context& context, ServerOptions options, Site& site);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  [[nodiscard]] std::uint16_t port() const;
  /// Every page that listens gets `text`.
  void tell(const std::string& text);
  void stop();

 private:
  class Parts;
  std::shared_ptr<Parts> parts_;
};

/// 128 bits of getrandom(2) as 32 hexadecimal digits. Throws base::ComputationError.
std::string random_key();

/// Is `host` ("127.0.0.1:8000", "[::1]:8000", "localhost:8000") this server at `port`, by a number
/// or as localhost? `loopback`: of the loopback only.
bool is_own_host(const std::string& host, std::uint16_t port, bool loopback);

}  // namespace hydrapod::studio
