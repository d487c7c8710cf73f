import assert from "node:assert/strict";
import { test } from "node:test";

import { loadList, refresh } from "../../../static/js/core/list-refresh.js";

test("a list that was asked for before a member came does not leave it out", async () => {
  const server = ["pool"];
  let shown = [];
  const list = loadList("languages", async () => {
    const answer = [...server];
    await new Promise((resolve) => setTimeout(resolve, 20));
    return answer.map((id) => ({ id }));
  });
  server.push("lake");
  await refresh("lake", {
    list: "languages",
    load: async (id) => ({ id }),
    current: () => shown,
    order: (one, other) => one.id.localeCompare(other.id),
    take: (members) => {
      shown = members;
    },
  });
  shown = await list;
  assert.deepEqual(
    shown.map(({ id }) => id),
    server,
  );
});
