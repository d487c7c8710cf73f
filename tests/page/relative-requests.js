// Requests to addresses relative to a page, which Node's own `Request` does not know.

const PAGE = "http://127.0.0.1/";

globalThis.Request = class extends Request {
  constructor(address, options) {
    super(typeof address === "string" ? new URL(address, PAGE) : address, options);
  }
};
