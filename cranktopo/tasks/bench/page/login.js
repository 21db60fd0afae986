// Asks for the password of a bench that other machines can reach.
document.getElementById("login").addEventListener("submit", async (event) => {
  event.preventDefault();
  const answer = await fetch("login", { method: "POST", body: document.getElementById("password").value });
  if (answer.ok) location.reload();
  else document.getElementById("told").textContent = "That is not the password. After ten wrong ones the bench takes none until it is started again.";
});
