/*
 * Browsers start no Worker for a page on disk (file:). There, this one runs the search's script in
 * a hidden frame instead. Material's stand-in of the same name would be loaded from the network.
 */
if (location.protocol === "file:") {
  window.IFrameWorker = class extends EventTarget {
    #frame = document.createElement("iframe");
    #ready;

    constructor(url) {
      super();
      this.#frame.hidden = true;
      document.body.append(this.#frame);
      const page = this.#frame.contentDocument;
      page.open(); // keeps Firefox from replacing it by an empty page later
      page.write("<!doctype html><body></body>");
      page.close();
      const inside = this.#frame.contentWindow;
      inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      inside.importScripts = () => {
        throw new Error("the search in other languages needs a web server");
      };
      const script = page.createElement("script");
      script.src = url;
      this.#ready = new Promise((resolve, reject) => {
        script.onload = resolve;
        script.onerror = reject;
      });
      page.body.append(script);
    }

    async postMessage(data) {
      await this.#ready;
      this.#frame.contentWindow.dispatchEvent(new MessageEvent("message", { data }));
    }

    terminate() {
      this.#frame.remove();
    }
  };
  window.Worker = window.IFrameWorker;
}
